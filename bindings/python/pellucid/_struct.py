"""Base of the generated structures: the C structure's own bytes, with attributes over them."""
from __future__ import annotations

import difflib
from collections.abc import Iterable
from enum import EnumMeta, IntEnum, IntFlag
from typing import Any, ClassVar, Generic, NoReturn, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from . import _native

E = TypeVar("E", bound=IntEnum)
T = TypeVar("T")
S = TypeVar("S", bound="Struct")


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """"; did you mean 'roughness'?" where a known name is close, else ""."""
    by_lower = {k.lower(): k for k in known}
    near = difflib.get_close_matches(str(name).lower(), by_lower, 1)
    return f"; did you mean {by_lower[near[0]]!r}?" if near else ""


class _PublicNames(type):
    """help() and completion show public names alone; Python's own methods fill hundreds of lines."""

    def __dir__(cls) -> list[str]:
        return [name for name in super().__dir__() if not name.startswith("_")]


class _MemberNames(EnumMeta):
    """Of an enumeration: its members, and none of the methods of int."""

    def __dir__(cls) -> list[str]:
        return ["__doc__", *cls.__members__]


class Enumeration(IntEnum, metaclass=_MemberNames):
    """Base of the enumerations."""


class Flags(IntFlag, metaclass=_MemberNames):
    """Base of the sets of bits."""


def to_enum(kind: type[E], value: Any, what: str) -> E:
    """An enumerator from itself, its number or its name in any letter case."""
    if isinstance(value, str):
        if value.upper() in kind.__members__:
            return kind[value.upper()]
    else:
        try:
            return kind(value)
        except ValueError:
            pass
    names = [name.lower() for name in kind.__members__]
    raise ValueError(f"{what} is {value!r}{did_you_mean(value, names)}; it must be one of {', '.join(names)}")


class OfThisProcess:
    """Objects of a device cannot be pickled; `_instead` tells what to do in another process."""

    _instead: ClassVar[str]

    def __reduce__(self) -> NoReturn:
        raise TypeError(f"a {type(self).__name__} belongs to this process and cannot be pickled: "
                        f"{self._instead}")


class Struct(metaclass=_PublicNames):
    """A C structure by value. Every field starts at the library's default; keyword arguments set others.

    Fields that are arrays come back read-only: assign a whole new value to change one.
    """

    _c_name: ClassVar[str]
    _dtype: ClassVar[np.dtype[Any]]
    _data: NDArray[Any]
    _kept: dict[str, Any]  # profiles by field, alive for the handles in _data

    def __new__(cls: type[S], *_: Any, **fields: Any) -> S:
        for name in fields:
            if name not in cls.field_names():
                raise TypeError(cls._unknown(name))
        return super().__new__(cls)

    @classmethod
    def _unknown(cls, name: str) -> str:
        known = cls.field_names()
        return f"{cls.__name__} has no field {name!r}{did_you_mean(name, known)}; it has {', '.join(known)}"

    def __init__(self, **fields: Any) -> None:
        # A writable copy of the library's own defaults, structSize included.
        self._data = np.frombuffer(bytearray(_native.struct_defaults(self._c_name)), self._dtype)
        self._kept = {}
        for name, value in fields.items():
            if value is not None:
                setattr(self, name, value)

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in ("_data", "_kept") and name not in self.field_names():
            raise AttributeError(self._unknown(name))
        super().__setattr__(name, value)

    @classmethod
    def _bytes_of(cls, value: Any) -> NDArray[Any]:
        """The C structure of `value`, which must be one of these."""
        if not isinstance(value, cls):
            raise TypeError(f"{value!r} is a {type(value).__name__}; a pellucid.{cls.__name__} is needed")
        return value._data

    @classmethod
    def field_names(cls) -> tuple[str, ...]:
        """The fields in the order of the C structure."""
        return tuple(n for n in cls._dtype.names or () if n != "struct_size")

    def to_dict(self) -> dict[str, Any]:
        """The fields as plain Python values, for JSON."""

        def plain(value: Any) -> Any:
            if isinstance(value, Struct):
                return value.to_dict()
            if isinstance(value, np.ndarray):
                return value.tolist()
            if hasattr(value, "evaluate"):  # a Profile
                return value.info.name
            return value.name.lower() if isinstance(value, IntEnum) else value

        return {name: plain(getattr(self, name)) for name in self.field_names()}

    @classmethod
    def _with(cls: type[S], given: S | None, fields: dict[str, Any]) -> S:
        """A copy of `given` (None: of the defaults) with some fields changed."""
        made = cls()
        if given is not None:
            made._data[...] = cls._bytes_of(given)
            made._kept = dict(given._kept)
        for name, value in fields.items():
            setattr(made, name, value)
        return made

    def copy(self: S) -> S:
        """An independent copy."""
        return self._with(self, {})

    __copy__ = copy

    def __deepcopy__(self: S, memo: Any) -> S:
        return self.copy()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{n}={getattr(self, n)!r}' for n in self.field_names())})"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self.to_dict() == other.to_dict()

    __hash__ = None  # type: ignore[assignment]


class Field(Generic[T]):
    """An attribute over a field of the C structure. Vectors and matrices (row-major, multiplying column
    vectors) come back read-only, structures as copies. `kind`: of enumerators and of structures."""

    def __init__(self, name: str, kind: type[T] | None = None) -> None:
        self.name, self.kind = name, kind

    @overload
    def __get__(self, owner: None, kind: Any) -> Field[T]: ...
    @overload
    def __get__(self, owner: Struct, kind: Any) -> T: ...
    def __get__(self, owner: Struct | None, kind: Any) -> Any:
        if owner is None:
            return self
        stored, of = owner._data[self.name][0], self.kind
        if of is not None and issubclass(of, Struct):
            inner = of()
            inner._data[0] = stored
            inner._kept = dict(owner._kept.get(self.name, {}))
            return inner
        if of is not None:
            return of(int(stored))  # type: ignore[call-arg]
        if isinstance(stored, bytes):
            return stored.decode("utf-8", "replace")
        if isinstance(stored, np.ndarray):
            stored = stored.copy()
            stored.flags.writeable = False
            return stored
        return stored.item()

    def __set__(self, owner: Struct, value: Any) -> None:
        kind, dtype, name = self.kind, owner._dtype[self.name], f"{type(owner).__name__}.{self.name}"

        def wrong(right: str) -> ValueError:
            return ValueError(f"{name} is {value!r}; it must be {right}")

        stored: Any
        if kind is not None and issubclass(kind, Struct):
            if not isinstance(value, kind):
                raise wrong(f"a {kind.__name__}")
            stored = value._data[0]
            owner._kept[self.name] = dict(value._kept)
        elif kind is not None:
            stored = int(to_enum(kind, value, name))  # type: ignore[type-var]
        elif dtype.kind == "S":
            stored = value.encode()
            if len(stored) >= dtype.itemsize:
                raise wrong(f"at most {dtype.itemsize - 1} bytes")
        elif dtype.kind in "iu":
            limits = np.iinfo(dtype)
            if not hasattr(value, "__index__"):
                raise wrong("an integer")
            stored = value.__index__()
            if not limits.min <= stored <= limits.max:
                raise wrong(f"from {limits.min} to {limits.max}")
        else:
            try:
                stored = np.asarray(value, dtype.base).reshape(dtype.shape) if dtype.shape else float(value)
            except (TypeError, ValueError):
                size = int(np.prod(dtype.shape))
                raise wrong(f"{size} numbers, shape {dtype.shape}" if dtype.shape else "a number") from None
        owner._data[self.name][0] = stored


class ProfileField(Field[Any]):
    """A diffusion profile, or the name of one of the library; None for none."""

    def __get__(self, owner: Struct | None, kind: Any) -> Any:
        return self if owner is None else owner._kept.get(self.name)

    def __set__(self, owner: Struct, value: Any) -> None:
        from .profile import as_profile

        profile = as_profile(value, f"{type(owner).__name__}.{self.name}")
        owner._kept[self.name] = profile
        owner._data[self.name] = 0 if profile is None else profile._handle.address()
