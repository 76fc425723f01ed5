#!/usr/bin/env bash
# Installs by name the Debian packages that a build needs and that are missing.
#
#   tools/ensure_debian.sh PYTHON build   what it takes to make the environment and compile
#   tools/ensure_debian.sh PYTHON test    and, besides, what the C++ tests link to
#   tools/ensure_debian.sh PYTHON firmware  and, besides, a cross compiler for Cortex-M and qemu
#   tools/ensure_debian.sh PYTHON bench  and, besides, peers of the speed bench: Eigen, and Rust's cargo
#
# A need is looked for by what it does, not by its package's name, so that a compiler or a Python
# from elsewhere is as good as Debian's.
set -euo pipefail

python=$1
purpose=$2
missing=()

if ! command -v "$python" >/dev/null; then
    echo "No Python 3.11 found; install the package python3.11, or say: make PYTHON=..." >&2
    exit 1
fi
if ! "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))'; then
    echo "$python is older than Python 3.11; say: make PYTHON=python3.11" >&2
    exit 1
fi
version=$("$python" -c 'import sys; print("python%d.%d" % sys.version_info[:2])')

command -v "${CXX:-g++}" >/dev/null || missing+=(g++)
"$python" -c 'import ensurepip, venv' 2>/dev/null || missing+=("$version-venv")
"$python" -c '
import pathlib, sys, sysconfig
sys.exit(not (pathlib.Path(sysconfig.get_path("include")) / "Python.h").exists())
' || missing+=("$version-dev")
if [[ $purpose == test ]]; then
    echo '#include <gtest/gtest.h>' | "${CXX:-g++}" -E -x c++ - >/dev/null 2>&1 ||
        missing+=(libgtest-dev)
    command -v nm >/dev/null || missing+=(binutils)
fi
if [[ $purpose == firmware ]]; then
    if ! echo '#include <type_traits>' |
        arm-none-eabi-g++ -mcpu=cortex-m4 -E -x c++ - >/dev/null 2>&1; then
        missing+=(gcc-arm-none-eabi libnewlib-arm-none-eabi libstdc++-arm-none-eabi-newlib)
    fi
    command -v qemu-system-arm >/dev/null || missing+=(qemu-system-arm)
fi
if [[ $purpose == bench ]]; then
    echo '#include <Eigen/Dense>' |
        "${CXX:-g++}" -E -x c++ -I/usr/include/eigen3 - >/dev/null 2>&1 || missing+=(libeigen3-dev)
    command -v cargo >/dev/null || missing+=(cargo)
fi

if ((${#missing[@]} == 0)); then
    exit 0
fi

as_root=()
if (($(id -u) != 0)); then
    as_root=(sudo -n)
fi
if ! command -v apt-get >/dev/null || ! "${as_root[@]}" true 2>/dev/null; then
    echo "Missing here: ${missing[*]} (names of Debian packages). Install them, then run make again." >&2
    exit 1
fi
echo "Installing Debian packages: ${missing[*]}"
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 -qq)
"${apt[@]}" update
"${apt[@]}" install --yes --no-install-recommends "${missing[@]}" >/dev/null
