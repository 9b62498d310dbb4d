"""What shared libraries of Linux (ELF), Windows (PE) and macOS (Mach-O) say of themselves, read from their bytes.

Each reader gives the names a library offers to others and what it needs from the system.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Library:
    """What a shared library offers and needs.

    Attributes:
        processor: "x86", "x86_64" or "aarch64"
        exported: names others can use
        needed: libraries it needs
        versions: symbol versions it needs of each of them (ELF)
        signed: whether it carries a code signature (Mach-O)
        system: oldest version of the system it runs on (Mach-O)
    """

    processor: str
    exported: frozenset[str]
    needed: frozenset[str]
    versions: frozenset[str] = field(default_factory=frozenset)
    signed: bool = False
    system: tuple[int, ...] = ()


def text_at(data: bytes, at: int) -> str:
    return data[at : data.index(b"\0", at)].decode()


def elf(data: bytes) -> Library:
    """A 64-bit little-endian ELF library."""
    assert data[:6] == b"\x7fELF\x02\x01"
    kind, processor = struct.unpack_from("<HH", data, 16)
    assert kind == 3, "a shared object"
    (table,), (count,) = struct.unpack_from("<Q", data, 0x28), struct.unpack_from("<H", data, 0x3C)
    # type, file offset, size and linked section of each section
    sections = [struct.unpack_from("<4xI8xQQQI", data, table + 64 * i) for i in range(count)]
    sections = [(kind, offset, size, link) for kind, _, offset, size, link in sections]

    def of(wanted: int) -> tuple[int, int, int]:
        """Begin, end and string table of the section of a type."""
        ((offset, size, link),) = [s[1:] for s in sections if s[0] == wanted]
        return offset, offset + size, sections[link][1]

    begin, end, names = of(11)
    exported = set()
    for at in range(begin, end, 24):
        name, info, _, section = struct.unpack_from("<IBBH", data, at)
        if section and info >> 4:
            exported.add(text_at(data, names + name))
    begin, end, names = of(6)
    entries = [struct.unpack_from("<QQ", data, at) for at in range(begin, end, 16)]
    needed = {text_at(data, names + value) for tag, value in entries if tag == 1}
    return Library(
        {0x3E: "x86_64", 0xB7: "aarch64"}[processor],
        frozenset(exported),
        frozenset(needed),
        frozenset(_elf_versions(data, *of(0x6FFFFFFE))),
    )


def _elf_versions(data: bytes, begin: int, end: int, names: int) -> Iterator[str]:
    at = begin
    while at < end:
        _, count, _, first, following = struct.unpack_from("<HHIII", data, at)
        entry = at + first
        for _ in range(count):
            _, _, _, name, next_entry = struct.unpack_from("<IHHII", data, entry)
            yield text_at(data, names + name)
            entry += next_entry
        if not following:
            return
        at += following


def pe(data: bytes) -> Library:
    """A library of Windows."""
    (head,) = struct.unpack_from("<I", data, 0x3C)
    assert data[:2] == b"MZ"
    assert data[head : head + 4] == b"PE\0\0"
    processor, count = struct.unpack_from("<HH", data, head + 4)
    (optional,) = struct.unpack_from("<H", data, head + 20)
    directories = head + 24 + (112 if processor == 0x8664 else 96)
    sections = [struct.unpack_from("<IIII", data, head + 24 + optional + 40 * i + 8) for i in range(count)]

    def place(address: int) -> int:
        ((at, file_at),) = [(v, f) for size, v, raw, f in sections if v <= address < v + max(size, raw)]
        return address - at + file_at

    exports, _, imports, _ = struct.unpack_from("<IIII", data, directories)
    (names_count,), (names,) = (struct.unpack_from("<I", data, place(exports) + k) for k in (24, 32))
    exported = {text_at(data, place(a)) for a in struct.unpack_from(f"<{names_count}I", data, place(names))}
    needed, at = set(), place(imports)
    while (name := struct.unpack_from("<I", data, at + 12)[0]) != 0:
        needed.add(text_at(data, place(name)).lower())
        at += 20
    return Library({0x8664: "x86_64", 0x14C: "x86"}[processor], frozenset(exported), frozenset(needed))


def universal(data: bytes) -> list[Library]:
    """The libraries inside a universal library of macOS."""
    magic, count = struct.unpack_from(">II", data)
    assert magic == 0xCAFEBABE
    slices = [struct.unpack_from(">IIIII", data, 8 + 20 * i) for i in range(count)]
    found = []
    for processor, _, offset, size, alignment in slices:
        assert offset % 2**alignment == 0
        assert offset + size <= len(data)
        inside = macho(data[offset : offset + size])
        assert inside.processor == {0x01000007: "x86_64", 0x0100000C: "aarch64"}[processor]
        found.append(inside)
    return found


def macho(data: bytes) -> Library:
    """A 64-bit library of macOS for one processor."""
    magic, processor, _, kind, count, _, _, _ = struct.unpack_from("<8I", data)
    assert (magic, kind) == (0xFEEDFACF, 6), "a 64-bit dynamic library"
    exported, needed, signed, system, at = set[str](), set[str](), False, tuple[int, ...](), 32
    for _ in range(count):
        command, size = struct.unpack_from("<II", data, at)
        if command == 0xC:  # LC_LOAD_DYLIB
            needed.add(text_at(data, at + struct.unpack_from("<I", data, at + 8)[0]))
        elif command in (0x22, 0x80000022, 0x80000033):  # LC_DYLD_INFO(_ONLY), LC_DYLD_EXPORTS_TRIE
            offset, length = struct.unpack_from("<II", data, at + (8 if command == 0x80000033 else 40))
            exported |= set(_trie(data[offset : offset + length]))
        elif command == 0x1D:  # LC_CODE_SIGNATURE
            signed = True
        elif command == 0x32:  # LC_BUILD_VERSION
            (version,) = struct.unpack_from("<I", data, at + 12)
            system = (version >> 16, version >> 8 & 0xFF)
        at += size
    name = {0x01000007: "x86_64", 0x0100000C: "aarch64"}[processor]
    return Library(name, frozenset(exported), frozenset(needed), signed=signed, system=system)


def _trie(data: bytes) -> Iterator[str]:
    """The names in a tree of names that share their beginnings."""

    def number(at: int) -> tuple[int, int]:
        value, shift = 0, 0
        while True:
            value |= (data[at] & 0x7F) << shift
            at, shift = at + 1, shift + 7
            if data[at - 1] < 0x80:
                return value, at

    left = [(0, "")] if data else []
    while left:
        at, begun = left.pop()
        size, at = number(at)
        if size:
            yield begun
        at += size
        branches, at = data[at], at + 1
        for _ in range(branches):
            label = text_at(data, at)
            child, at = number(at + len(label) + 1)
            left.append((child, begun + label))
