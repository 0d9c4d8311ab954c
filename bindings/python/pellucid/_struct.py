"""Base of the generated structures: the C structure's own bytes, with attributes over them."""
from __future__ import annotations

import difflib
from collections.abc import Iterable
from enum import EnumMeta, IntEnum, IntFlag
from typing import Any, ClassVar, Generic, NoReturn, TypeVar, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
    """What a device holds cannot be pickled; `_instead` says what another process does."""

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
    _profile: Any = None  # kept alive for the handle in _data

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
        for name, value in fields.items():
            if value is not None:
                setattr(self, name, value)

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in ("_data", "_profile") and name not in self.field_names():
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

    def copy(self: S) -> S:
        """An independent copy."""
        other = type(self)()
        other._data[...] = self._data
        other._profile = self._profile
        return other

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{n}={getattr(self, n)!r}' for n in self.field_names())})"

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self.to_dict() == other.to_dict()

    __hash__ = None  # type: ignore[assignment]


class _Field(Generic[T]):
    """An attribute over a field of the C structure."""

    def __init__(self, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, owner: None, kind: Any) -> _Field[T]: ...
    @overload
    def __get__(self, owner: Struct, kind: Any) -> T: ...
    def __get__(self, owner: Struct | None, kind: Any) -> Any:
        return self if owner is None else self._read(owner, owner._data[self.name][0])

    def _read(self, owner: Struct, stored: Any) -> T:
        raise NotImplementedError

    def _fail(self, owner: Struct, value: Any, right: str) -> ValueError:
        return ValueError(f"{type(owner).__name__}.{self.name} is {value!r}; it must be {right}")


class FloatField(_Field[float]):
    """A float32 or float64."""

    def _read(self, owner: Struct, stored: Any) -> float:
        return float(stored)

    def __set__(self, owner: Struct, value: float) -> None:
        try:
            owner._data[self.name] = float(value)
        except (TypeError, ValueError):
            raise self._fail(owner, value, "a number") from None


class IntField(_Field[int]):
    """An unsigned integer or a flag."""

    def _read(self, owner: Struct, stored: Any) -> int:
        return int(stored)

    def __set__(self, owner: Struct, value: int) -> None:
        limits = np.iinfo(owner._dtype[self.name])
        try:
            number = value.__index__()
        except AttributeError:
            raise self._fail(owner, value, "an integer") from None
        if not limits.min <= number <= limits.max:
            raise self._fail(owner, value, f"from {limits.min} to {limits.max}")
        owner._data[self.name] = number


class ArrayField(_Field[NDArray[Any]]):
    """A vector or a matrix (row-major, multiplying column vectors)."""

    def _read(self, owner: Struct, stored: Any) -> NDArray[Any]:
        values: NDArray[Any] = stored.copy()
        values.flags.writeable = False
        return values

    def __set__(self, owner: Struct, value: ArrayLike) -> None:
        shape = owner._dtype[self.name].shape
        size = int(np.prod(shape))
        try:
            values = np.asarray(value, dtype=owner._dtype[self.name].base)
        except (TypeError, ValueError):
            raise self._fail(owner, value, f"{size} numbers") from None
        if values.size != size:
            raise self._fail(owner, value, f"{size} numbers, shape {shape}")
        owner._data[self.name][0] = values.reshape(shape)


class TextField(_Field[str]):
    """A string of limited length."""

    def _read(self, owner: Struct, stored: Any) -> str:
        return bytes(stored).decode("utf-8", "replace")

    def __set__(self, owner: Struct, value: str) -> None:
        data, size = value.encode(), owner._dtype[self.name].itemsize
        if len(data) >= size:
            raise self._fail(owner, value, f"at most {size - 1} bytes")
        owner._data[self.name] = data


class ProfileField(_Field[Any]):
    """A diffusion profile, or the name of one of the library; None for none."""

    def _read(self, owner: Struct, stored: Any) -> Any:
        return owner._profile

    def __set__(self, owner: Struct, value: Any) -> None:
        from .profile import as_profile

        profile = as_profile(value, f"{type(owner).__name__}.{self.name}")
        owner._profile = profile
        owner._data[self.name] = 0 if profile is None else profile._handle.address()


class EnumField(_Field[E]):
    """One of a list of names."""

    def __init__(self, name: str, kind: type[E]) -> None:
        super().__init__(name)
        self.kind = kind

    def _read(self, owner: Struct, stored: Any) -> E:
        return self.kind(int(stored))

    def __set__(self, owner: Struct, value: E | str) -> None:
        owner._data[self.name] = int(to_enum(self.kind, value, f"{type(owner).__name__}.{self.name}"))


class StructField(_Field[S]):
    """A structure inside a structure; comes back as a copy."""

    def __init__(self, name: str, kind: type[S]) -> None:
        super().__init__(name)
        self.kind = kind

    def _read(self, owner: Struct, stored: Any) -> S:
        inner = self.kind()
        inner._data[0] = stored
        return inner

    def __set__(self, owner: Struct, value: S) -> None:
        if not isinstance(value, self.kind):
            raise self._fail(owner, value, f"a {self.kind.__name__}")
        owner._data[self.name][0] = value._data[0]
