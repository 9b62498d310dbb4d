"""From C source to a shared library by the compiler of the ziglang package: no compiler of the system is needed."""

from __future__ import annotations

import hashlib
import os
import platform as host
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from types import MappingProxyType

from ..model.errors import FmuError, suggestion
from ..model.files import replacing
from .fixed import tables, wrapper


@dataclass(frozen=True)
class Platform:
    """A platform of FMI: folder and file ending of its binary, and the compiler's targets (several are joined)."""

    name: str
    suffix: str
    targets: tuple[str, ...]


def _platforms(version: str) -> dict[str, Platform]:
    rows = tables("platforms")[version].items()
    return {name: Platform(name, suffix, tuple(targets)) for name, (suffix, *targets) in rows}


#: The platforms of FMI 2.0 by name.
PLATFORMS = _platforms("fmi2")
#: Those of FMI 3.0.
PLATFORMS_3 = _platforms("fmi3")

#: How much the compiler optimises what is kept.
THOROUGH = "-O2"
#: What runs little: ready in a fifth of the time, it takes three to four times as long to run, to the same digits.
QUICK = "-O0"
#: Any change makes the compiler rebuild its run-time libraries. To look for statements that would fill a vector takes a
#: quarter of its time and gains none in the running: rows stand side by side already.
CODE = (
    *("-g0", "-fPIC", "-fvisibility=hidden", "-fno-sanitize=all", "-ffp-contract=off", "-std=c99"),
    *("-fno-slp-vectorize", "-fno-stack-protector"),
)
LINK = ("-s", "-shared")
FLAGS = (*CODE, *LINK)
#: The system's C library of Windows. What it lacks is in wrapper/windows.c; the compiler's own would have to be built
#: first, from 400 files.
_SYSTEM = tuple(f"-lapi-ms-win-crt-{name}-l1-1-0" for name in ("math", "heap", "stdio", "string", "private"))

#: A module of WebAssembly. It imports nothing and exports the drivers and the memory, so that a page needs no glue. Two
#: rows side by side fill its vectors.
WEB = Platform("wasm32", ".wasm", ("wasm32-wasi",))
_WEB_CODE = ("-Os", "-DLANES=2", "-msimd128", "-g0", "-fvisibility=hidden", "-fno-sanitize=all", "-ffp-contract=off")
_WEB_EXPORTS = "-Wl,--export-dynamic,--export=malloc,--export=free,--export-table,--growable-table"
_WEB_LINK = ("-std=c99", "-s", "-mexec-model=reactor", _WEB_EXPORTS)
_WEB = (*_WEB_CODE, *_WEB_LINK)

#: Compilers that run at once, whoever asks.
_AT_ONCE = threading.BoundedSemaphore(os.cpu_count() or 1)

#: Called with what long work does or has done, and the share of all work that is done.
Progress = Callable[[str, float], None]


def host_platform() -> Platform:
    """The platform this program runs on."""
    if host.system() == "Linux" and host.machine() == "aarch64":
        return replace(PLATFORMS["aarch64-linux"], name="linux64")
    return PLATFORMS[{"Windows": "win64", "Darwin": "darwin64"}.get(host.system(), "linux64")]


def _host_of_3() -> Platform:
    system = {"Windows": "windows", "Darwin": "darwin"}.get(host.system(), "linux")
    arm = host.machine().lower() in ("aarch64", "arm64")
    return PLATFORMS_3.get(f"{'aarch64' if arm else 'x86_64'}-{system}", PLATFORMS_3[f"x86_64-{system}"])


def platforms(choice: str, fmi: int = 2) -> tuple[Platform, ...]:
    """The platforms meant by "host", "all", or names separated by commas.

    Args:
        choice: in words
        fmi: version of the standard, 2 or 3, whose names are meant; 3 takes the names of 2 as well

    Raises:
        FmuError: unknown platform
    """
    names_of, own = (PLATFORMS, host_platform()) if fmi == 2 else (PLATFORMS_3, _host_of_3())
    if choice == "all":
        return tuple(p for name, p in names_of.items() if "wasm" not in name)
    names = [own.name if name.strip() == "host" else name.strip() for name in choice.split(",")]
    if fmi == 3:
        names = [of_3 for name in names for of_3 in tables("platforms")["in_3"].get(name, (name,))]
    known = ("host", "all", *names_of)
    unknown = [n for n in names if n not in names_of]
    if fmi == 2 and WEB.name in unknown:
        raise FmuError(f'platform "{WEB.name}" is one of FMI 3.0. Add --fmi 3.')
    if unknown:
        raise FmuError(f'platform "{n}" is unknown.{suggestion(n, known)} Known: {", ".join(known)}.' for n in unknown)
    return tuple(names_of[n] for n in dict.fromkeys(names))


def cache_folder() -> Path:
    """The user's cache folder of this project; a temporary one of a user who has no home."""
    try:
        return _usual_cache()
    except RuntimeError:
        return Path(tempfile.gettempdir()) / "gearheat"


def _usual_cache() -> Path:
    if folder := os.environ.get("XDG_CACHE_HOME"):
        return Path(folder) / "gearheat"
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA", Path.home() / "AppData" / "Local")) / "gearheat" / "cache"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches" / "gearheat"
    return Path.home() / ".cache" / "gearheat"


def binary(
    source: str,
    platform: Platform,
    *,
    headers: Mapping[str, str] = MappingProxyType({}),
    ways: Sequence[str] = (THOROUGH,),
) -> bytes:
    """The shared library of a C source; the same source is compiled once only.

    Args:
        source: the C text
        platform: the platform of FMI to compile for
        headers: name -> text of files beside the source
        ways: how much it may be optimised: what is kept of any of them is taken, and the last is made

    Raises:
        FmuError: the compiler is missing or fails, or the cache cannot be written
    """
    windows = wrapper("windows.c")
    named = (platform.name, *platform.targets, *FLAGS, *_SYSTEM, version("ziglang"))
    named += _WEB if "wasm" in platform.name else ()
    for way in ways:
        key = hashlib.sha256()
        for part in (source, *headers.values(), windows, way, *named):
            key.update(part.encode() + b"\0")
        stored = cache_folder() / "binaries" / f"{key.hexdigest()}{platform.suffix}"
        if (kept := _kept(stored)) is not None:
            return kept
    files = {"all.c": source, "windows.c": windows, **headers}
    with ThreadPoolExecutor(len(platform.targets)) as pool:
        made = _join(list(pool.map(lambda target: _compile(files, target, way), platform.targets)))
    store(stored, hashlib.sha256(made).digest() + made)
    return made


def _kept(path: Path) -> bytes | None:
    """A binary of the cache; None where there is none, it is not as it was written, or others may write there."""
    try:
        content = path.read_bytes()
        about = path.parent.stat()
    except OSError:
        return None
    mine = not hasattr(os, "getuid") or (about.st_uid == os.getuid() and not about.st_mode & 0o022)
    digest, made = content[:32], content[32:]
    return made if mine and hashlib.sha256(made).digest() == digest else None


def compile_all(
    build: Callable[[Platform], bytes], platforms: Sequence[Platform], progress: Progress
) -> dict[str, bytes]:
    """The binaries of several platforms by name, made side by side.

    Args:
        build: makes the binary of one platform
        platforms: of which
        progress: called after each
    """
    with ThreadPoolExecutor(len(platforms)) as pool:
        jobs = {pool.submit(build, platform): platform.name for platform in platforms}
        for number, job in enumerate(as_completed(jobs), 1):
            progress(f"compiled for {jobs[job]}", number / len(jobs))
    return {name: job.result() for job, name in jobs.items()}


def store(path: Path, content: bytes) -> None:
    """Write a file so that nobody ever sees half of it.

    Args:
        path: the file; its folder is made
        content: what it is to hold

    Raises:
        FmuError: the folder or the file cannot be written
    """
    try:
        make_private(path.parent)
        with replacing(path) as beside:
            beside.write_bytes(content)
    except OSError as error:
        raise FmuError(
            f"{path}: cannot be written ({error.strerror}). Choose a file in a folder you may write to."
        ) from error


def why_not_loaded(error: Exception, folder: Path | str) -> str:
    """Why code in a folder does not load, in words.

    Args:
        error: what loading it has raised
        folder: where it lies
    """
    banned = hasattr(os, "statvfs") and os.statvfs(folder).f_flag & getattr(os, "ST_NOEXEC", 0)
    remedy = "no code runs from that file system (noexec). Set TMPDIR to a folder of another one"
    return f"{tempfile.gettempdir()}: {remedy}." if banned else str(error)


def make_private(folder: Path) -> None:
    """Make a folder and those above it that its owner alone may enter."""
    if not folder.is_dir():
        make_private(folder.parent)
        folder.mkdir(mode=0o700, exist_ok=True)


def compile_told(source: str, headers: Mapping[str, str]) -> str:
    """What the compiler says of the frames of a C source's functions, compiled for this machine.

    Args:
        source: the C text
        headers: name -> text of files beside it

    Raises:
        FmuError: the compiler is missing or fails
    """
    target = host_platform().targets[0]
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, THOROUGH, *CODE, "-Wframe-larger-than=0", "-c"]
    with tempfile.TemporaryDirectory() as folder, _AT_ONCE:
        for name, text in {"all.c": source, **headers}.items():
            Path(folder, name).write_text(text, encoding="utf-8")
        return _run([*command, "all.c"], target, folder, _environment())


def _environment() -> dict[str, str]:
    environment = dict(os.environ)
    for variable, folder in (("ZIG_GLOBAL_CACHE_DIR", "global"), ("ZIG_LOCAL_CACHE_DIR", "local")):
        environment.setdefault(variable, str(cache_folder() / "zig" / folder))
    return environment


def _compile(files: Mapping[str, str], target: str, way: str) -> bytes:
    environment = _environment()
    with tempfile.TemporaryDirectory() as folder, _AT_ONCE:
        for name, text in files.items():
            Path(folder, name).write_text(text, encoding="utf-8")
        for command in _commands(target, files, way):
            _run([sys.executable, "-m", "ziglang", "cc", "-target", target, *command], target, folder, environment)
        return Path(folder, "library").read_bytes()


def _commands(target: str, files: Iterable[str], way: str) -> list[list[str]]:
    """What the compiler is asked for, one after the other; a module of WebAssembly joins all C files but windows.c."""
    if "wasm" in target:
        return [[*_WEB, "-o", "library", *(name for name in files if name.endswith(".c") and name != "windows.c")]]
    if "windows" not in target:
        return [[way, *FLAGS, "-o", "library", "all.c", "-lm"]]
    objects = [[way, *CODE, "-c", "-o", f"{name}.o", f"{name}.c"] for name in ("all", "windows")]
    return [*objects, [*LINK, "-nostdlib", "-o", "library", "all.o", "windows.o", *_SYSTEM]]


def _run(command: Sequence[str], target: str, folder: str, environment: Mapping[str, str]) -> str:
    try:
        run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    except OSError as error:
        raise FmuError(f"the compiler does not start ({error.strerror}). Install it: pip install ziglang") from error
    if run.returncode != 0:
        said = run.stderr.splitlines() or ["no message"]
        first = next((line for line in said if "error" in line), said[0])
        hint = " Install it: pip install ziglang" if "No module named" in run.stderr else ""
        raise FmuError(f"compiling for {target} failed: {first[:300]}.{hint}")
    return run.stderr


def _join(slices: list[bytes]) -> bytes:
    """One library from those of several processors: a universal binary of macOS, or the only slice as it is."""
    if len(slices) == 1:
        return slices[0]
    alignment = 14  # 2**14 bytes, the page of the newer processor
    head, body, offset = [(0xCAFEBABE).to_bytes(4, "big"), len(slices).to_bytes(4, "big")], b"", 8 + 20 * len(slices)
    start = offset
    for content in slices:
        position = -(-offset // 2**alignment) * 2**alignment
        processor = content[4:8][::-1] + content[8:12][::-1]  # the slice's own header, little-endian
        head.append(processor + b"".join(n.to_bytes(4, "big") for n in (position, len(content), alignment)))
        body += bytes(position - start - len(body)) + content
        offset = position + len(content)
    return b"".join(head) + body
