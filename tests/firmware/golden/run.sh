#!/usr/bin/env bash
# Builds the golden image for a Cortex-M4F and runs it under qemu; answers go to OUT.
#
#   tests/firmware/golden/run.sh OUT HEADER_FOLDER [FLAG...]
#
# FLAG: for the compiler, for example -ffp-contract=off or -DGOLDEN_DOUBLE.
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../../.." && pwd)
out=$1
header=$(cd "$2" && pwd)
shift 2

mkdir -p "$out"
cd "$out"
arm-none-eabi-g++ -std=c++20 -O2 -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard \
    -ffreestanding -fno-math-errno -fno-exceptions -fno-rtti -fno-threadsafe-statics \
    -ffunction-sections -fdata-sections \
    -Wall -Wextra -Werror "$@" -I"$root/include" -I"$root/tests/golden" -I"$header" \
    "$here/startup.cpp" "$here/main.cpp" \
    -nostartfiles -nostdlib -Wl,--gc-sections -T"$here/mps2_an386.ld" -lm -lc -lgcc -o golden.elf
rm -f golden-answers.bin
timeout 600 qemu-system-arm -machine mps2-an386 -nographic -monitor none -serial null \
    -semihosting-config enable=on,target=native -kernel golden.elf 2>&1
