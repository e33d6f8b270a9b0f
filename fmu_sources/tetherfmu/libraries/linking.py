"""Link kernels without a C library: the linkers inside the package `ziglang`, and stubs with symbol names only.

No library is compiled, so an empty cache costs nothing. ELF: stub libraries with the symbol versions of glibc, made by the
linker itself from lists of names. PE: import libraries made from lists of names; the Universal C Runtime is part of Windows.
Mach-O: the linker includes the names of libSystem.
"""

import subprocess
import tempfile
from pathlib import Path

MATHEMATICS = ("sqrt", "exp", "log", "log1p", "pow", "asinh", "sinh", "atan2", "ceil")
MEMORY = ("memset", "memcpy")
KERNELS_NEED = {  # names, by their library on Linux and on Windows
    ("libm.so.6", "math"): MATHEMATICS,
    ("libc.so.6", "string"): ("memset",),
    ("libc.so.6", "private"): ("memcpy",),
}
ELF = {  # emulation of the linker, version of glibc's symbols, and the younger ones
    "x86_64-linux": ("elf_x86_64", "GLIBC_2.2.5", {"memcpy": "GLIBC_2.14"}),
    "aarch64-linux": ("aarch64linux", "GLIBC_2.17", {}),
}
PE = "api-ms-win-crt-{}-l1-1-0"  # a library of Windows
TARGETS = {  # Zig's names of the platforms
    "x86_64-linux": "x86_64-linux-gnu.2.17",
    "aarch64-linux": "aarch64-linux-gnu.2.17",
    "x86_64-windows": "x86_64-windows-gnu",
    "x86_64-darwin": "x86_64-macos.11.0",
    "aarch64-darwin": "aarch64-macos.11.0",
}


def link(objects, library, platform, exported, needed=None):
    """Bytes of the shared library that object files become; RuntimeError with the linker's words if it fails.

    objects : list of bytes.  library : its file name.  exported : names of the functions that others call.
    needed : names of the C library, as `KERNELS_NEED`, which it is if it is None.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        names = [f"{place}.o" for place in range(len(objects))]
        for name, content in zip(names, objects, strict=True):
            (folder / name).write_bytes(content)
        if platform in ELF:
            _link_elf(folder, library, names, platform, needed or KERNELS_NEED, exported)
        elif platform.endswith("darwin"):
            options = ("-dynamic", "-OReleaseSmall", "-fstrip", "-fno-compiler-rt", "-lc", "-target", TARGETS[platform])
            zig(folder, "build-lib", *options, f"-femit-bin={library}", *names)
        else:
            _link_pe(folder, library, names, needed or KERNELS_NEED, exported)
        return (folder / library).read_bytes()


def _link_elf(folder, library, objects, platform, needed, exported):
    """Link for Linux."""
    emulation, usual, younger = ELF[platform]
    libraries = {}
    for (name, _), listed in needed.items():
        libraries.setdefault(name, []).extend(listed)
    for name, listed in libraries.items():
        groups = {}
        for each in listed:
            groups.setdefault(younger.get(each, usual), []).append(each)
        stubs = [f"{each} = 0;\n" for each in listed]
        versions = [f"{version} {{ global: {'; '.join(each)}; }};\n" for version, each in groups.items()]
        (folder / "names.ld").write_text("".join(stubs))
        (folder / "names.map").write_text("".join(versions))
        options = ("-shared", "-soname", name, "--version-script", "names.map", "-o", name)
        zig(folder, "ld.lld", "-m", emulation, *options, "names.ld")
    (folder / "exported.map").write_text(f"{{ global: {'; '.join(exported)}; local: *; }};\n")
    options = ("-shared", "-s", "--gc-sections", "--as-needed", "--no-undefined", "-z", "noexecstack", "-soname", library)
    options += ("--version-script", "exported.map")
    zig(folder, "ld.lld", "-m", emulation, *options, "-o", library, *objects, *libraries)


def _link_pe(folder, library, objects, needed, exported):
    """Link for Windows on x86-64."""
    for (_, part), listed in needed.items():
        name = PE.format(part)
        (folder / f"{name}.def").write_text("\n".join([f"LIBRARY {name}.dll", "EXPORTS", *listed, ""]))
        zig(folder, "dlltool", "-m", "i386:x86-64", "-D", f"{name}.dll", "-d", f"{name}.def", "-l", f"{name}.lib")
    options = ("/dll", "/noentry", "/machine:x64", "/nodefaultlib", "/brepro", "/opt:ref", "/lldmingw", f"/out:{library}")
    exports = [f"/export:{name}" for name in exported]
    zig(folder, "lld-link", *options, *exports, *objects, *(f"{PE.format(part)}.lib" for _, part in needed))


def compile_c(folder, source, platform, options):
    """Object file (bytes) of a C file for a platform, compiled in a folder by Zig with options of the compiler."""
    zig(folder, "cc", "-target", TARGETS[platform], *options, "-c", str(source), "-o", "compiled.o")
    return (folder / "compiled.o").read_bytes()


def zig(folder, *command):
    """Run one of Zig's tools in a folder."""
    import ziglang

    program = str(Path(ziglang.__file__).with_name("zig"))
    done = subprocess.run([program, *command], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"linking failed: zig {' '.join(command)}: {(done.stderr or done.stdout).strip()}")
