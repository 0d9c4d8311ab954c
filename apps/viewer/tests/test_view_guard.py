"""The viewer's guard: which requests are admitted, whatever cookies other programs have set."""
import asyncio
import importlib
import re
import socket

import pytest

from pellucid.view.__main__ import address, free_port, main
from pellucid.view.guard import Guard, Keys, cookie_values


@pytest.mark.parametrize("unit", ["0", "-1", "nan"])
def test_a_unit_has_a_length(unit, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["pellucid view", "--unit-mm", unit])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2 and "--unit-mm must be above 0" in capsys.readouterr().err


@pytest.mark.parametrize("program, options", [
    ("view.__main__", {"port"}), ("view.gallery", {"size"}),
    ("batch.__main__", {"timeout", "patience"})])
def test_help_states_the_defaults(program, options, monkeypatch):
    def parse(parser):
        stated = {a.dest: (float(found[1]), a.default) for a in parser._actions
                  if (found := re.search(r"\((?:default: )?([\d.]+)\)", a.help or ""))}
        assert set(stated) == options and all(said == default for said, default in stated.values())
        parser.exit()

    monkeypatch.setattr("argparse.ArgumentParser.parse_args", parse)
    with pytest.raises(SystemExit):
        importlib.import_module(f"pellucid.{program}").main()


def ask(guard, path="/", query="", cookie=None, kind="http", **headers):
    """(status, headers) of one request; 200 where the application was reached."""
    sent = []

    async def send(message):
        sent.append(message)

    async def receive():
        return {"type": f"{kind}.connect"}

    lines = [(b"host", b"127.0.0.1:8350"), *((k.encode(), v.encode("latin-1")) for k, v in headers.items())]
    for text in [cookie] if isinstance(cookie, str) else cookie or []:
        lines.append((b"cookie", text.encode("latin-1")))
    scope = {"type": kind, "path": path, "query_string": query.encode(), "headers": lines}
    asyncio.run(guard(scope, receive, send))
    first = sent[0]
    return first.get("status", first.get("code")), dict(first.get("headers", []))


@pytest.fixture
def guard():
    async def app(scope, receive, send):
        await send({"type": "http.response.start", "status": 200, "headers": []})

    return Guard(app, Keys(8350))


def let_in(guard):
    """The cookie that the key of the address is exchanged for."""
    status, headers = ask(guard, query=f"token={guard.keys.key}")
    assert status == 303 and headers[b"location"] == b"/"
    return headers[b"set-cookie"].decode().split(";")[0]


# Cookies that other programs on 127.0.0.1 set: JSON, slashes, open quotes, no value, no name, other letters.
OTHERS = ['prefs={"a":1}', "a/b=1", 'x="open', "alone", "=", ";;;", "name=\x01\xff", "pellucid_view_8350",
          "a=b=c"]


@pytest.mark.parametrize("other", OTHERS)
def test_cookies_of_other_programs_do_no_harm(guard, other):
    own = let_in(guard)
    for cookies in (f"{other}; {own}", f"{own}; {other}", [other, own]):
        assert ask(guard, cookie=cookies)[0] == 200
    assert ask(guard, cookie=other)[0] == 403
    assert ask(guard, cookie=other, query=f"token={guard.keys.key}")[0] == 303


def test_an_address_is_valid_once_and_its_key_is_not_the_cookie(guard):
    key, fresh = guard.keys.key, []
    guard.keys._used = fresh.append
    own = let_in(guard)
    assert key not in own and own.startswith("pellucid_view_8350=")
    assert ask(guard, query=f"token={key}")[0] == 403
    assert fresh == [guard.keys.key] and ask(guard, query=f"token={fresh[0]}")[0] == 303
    assert ask(guard, cookie=own)[0] == 200  # those who are in stay in


def test_a_chosen_token_stays_valid(guard):
    guard.keys = Keys(8350, "mine")
    assert [ask(guard, query="token=mine")[0] for _ in range(2)] == [303, 303]
    guard.keys = Keys(8350, "a+b &c%25")
    assert ask(guard, query=address("127.0.0.1", 8350, "a+b &c%25").split("?")[1])[0] == 303
    assert ask(guard, query="token=min\u00e9".encode().decode("latin-1"))[0] == 403


def test_cookies_of_another_viewer_or_site_are_refused(guard):
    assert cookie_values('n=1; m=2; n="3";n', "n") == ["1", "3"]
    own = let_in(guard)
    # Another program on this host may set a cookie of this name.
    for cookies in (f"{own}; pellucid_view_8350=x", f"pellucid_view_8350=x; {own}"):
        assert ask(guard, cookie=cookies)[0] == 200
    assert ask(guard, cookie=own.replace("8350", "8351"))[0] == 403
    assert ask(guard, cookie=own, kind="websocket", origin="http://127.0.0.1:8350")[0] == 200
    assert ask(guard, cookie=own, kind="websocket", origin="http://elsewhere.example")[0] == 1008
    assert ask(guard, kind="websocket")[0] == 1008
    assert ask(guard, cookie="pellucid_view_8350=wrong")[0] == 403


def test_the_next_free_port_is_taken():
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert port < free_port("127.0.0.1", port) <= port + 50
    assert free_port("127.0.0.1", port) == port
    with pytest.raises(OSError):
        free_port("256.0.0.1", port)
