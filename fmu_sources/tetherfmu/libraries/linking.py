"""Link kernels without a C library: the linkers inside the package `ziglang`, and stubs that only name what is needed.

Nothing is compiled, so an empty cache costs nothing. ELF: stub libraries with the symbol versions of glibc, made by the
linker itself from lists of names. PE: import libraries made from lists of names; the Universal C Runtime is part of Windows.
Mach-O: the names of libSystem come with the linker.
"""

import subprocess
import tempfile
from pathlib import Path

from tetherfmu.runtime.kernel_library import file_name, verbs

MATHEMATICS = ("sqrt", "exp", "log", "log1p", "pow", "asinh", "sinh", "atan2", "ceil")
MEMORY = ("memset", "memcpy")
ELF = {  # emulation of the linker, and {library: {version of its symbols: names}}
    "x86_64-linux": (
        "elf_x86_64",
        {"libm.so.6": {"GLIBC_2.2.5": MATHEMATICS}, "libc.so.6": {"GLIBC_2.2.5": ("memset",), "GLIBC_2.14": ("memcpy",)}},
    ),
    "aarch64-linux": ("aarch64linux", {"libm.so.6": {"GLIBC_2.17": MATHEMATICS}, "libc.so.6": {"GLIBC_2.17": MEMORY}}),
}
PE = {  # libraries of Windows: names
    "api-ms-win-crt-math-l1-1-0": MATHEMATICS,
    "api-ms-win-crt-string-l1-1-0": ("memset",),
    "api-ms-win-crt-private-l1-1-0": ("memcpy",),
}
MACHO = {"aarch64-darwin": "aarch64-macos.11.0", "x86_64-darwin": "x86_64-macos.11.0"}  # target of the linker


def link(code, variant, platform):
    """Bytes of the shared library that an object file (bytes) becomes; RuntimeError with the linker's words if it fails."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        (folder / "kernels.o").write_bytes(code)
        library = file_name(variant, platform)
        if platform in ELF:
            _link_elf(folder, library, *ELF[platform])
        elif platform in MACHO:
            options = ("-dynamic", "-OReleaseSmall", "-fstrip", "-fno-compiler-rt", "-lc", "-target", MACHO[platform])
            _zig(folder, "build-lib", *options, f"-femit-bin={library}", "kernels.o")
        else:
            _link_pe(folder, library, [f"{variant}_{verb}" for verb in verbs(variant)])
        return (folder / library).read_bytes()


def _link_elf(folder, library, emulation, needed):
    """Link for Linux."""
    for name, versions in needed.items():
        stubs = [f"{each} = 0;\n" for names in versions.values() for each in names]
        groups = [f"{version} {{ global: {'; '.join(names)}; }};\n" for version, names in versions.items()]
        (folder / "names.ld").write_text("".join(stubs))
        (folder / "names.map").write_text("".join(groups))
        options = ("-shared", "-soname", name, "--version-script", "names.map", "-o", name)
        _zig(folder, "ld.lld", "-m", emulation, *options, "names.ld")
    options = ("-shared", "-s", "--gc-sections", "--as-needed", "--no-undefined", "-z", "noexecstack", "-soname", library)
    _zig(folder, "ld.lld", "-m", emulation, *options, "-o", library, "kernels.o", *needed)


def _link_pe(folder, library, exported):
    """Link for Windows on x86-64."""
    for name, names in PE.items():
        (folder / f"{name}.def").write_text("\n".join([f"LIBRARY {name}.dll", "EXPORTS", *names, ""]))
        _zig(folder, "dlltool", "-m", "i386:x86-64", "-D", f"{name}.dll", "-d", f"{name}.def", "-l", f"{name}.lib")
    options = ("/dll", "/noentry", "/machine:x64", "/nodefaultlib", "/brepro", "/opt:ref", "/lldmingw", f"/out:{library}")
    exports = [f"/export:{name}" for name in exported]
    _zig(folder, "lld-link", *options, *exports, "kernels.o", *(f"{name}.lib" for name in PE))


def _zig(folder, *command):
    """Run one of Zig's tools in a folder."""
    import ziglang

    program = str(Path(ziglang.__file__).with_name("zig"))
    done = subprocess.run([program, *command], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"linking failed: zig {' '.join(command)}: {(done.stderr or done.stdout).strip()}")
