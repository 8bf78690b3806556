"""A Cortex-M4 on unicorn, whose surroundings come from a trace.

Unicorn executes instructions; it has neither interrupt controller nor private registers. Exceptions
are entered here where the trace says so, and returned from as the Armv7-M manual defines it.
"""

import struct

from unicorn import UC_ARCH_ARM, UC_HOOK_BLOCK, UC_HOOK_INTR, UC_MODE_MCLASS, UC_MODE_THUMB
from unicorn import Uc, UcError
from unicorn import arm_const as arm

from inputs import END, ENTRY, HOST_READ, HOST_WRITE, LOAD, READ, RESET, WRITE

FLASH, RAM = 0x08000000, 0x20000000
# Begin and length. Bank 1 and 2 of the flash, system memory with the factory's words, RAM.
MEMORIES = ((FLASH, 0x200000), (0x1FFF0000, 0x10000), (RAM, 0x30000))
PERIPHERALS, PRIVATE = 0x40000000, 0xE0000000
BIT_BAND = range(0x42000000, 0x44000000)
DBGMCU = range(0xE0042000, 0xE0042400)
SYSTEM_CONTROL = range(0xE000E000, 0xE000F000)
ICSR, CFSR, HFSR, MMFAR, BFAR = (0xE000E000 + at for at in (0xD04, 0xD28, 0xD2C, 0xD34, 0xD38))
# PRECISERR and BFARVALID in CFSR; FORCED in HFSR.
PRECISE, FORCED = 1 << 9 | 1 << 15, 1 << 30
DAC = range(0x40007400, 0x40007800)
# Bits of CONTROL and of EXC_RETURN: floating-point registers are in use; they are not in the frame.
FPCA, BASIC_FRAME = 1 << 2, 1 << 4
# Unicorn's number of a branch to an EXC_RETURN value.
EXCEPTION_EXIT = 8
CORE = [arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3]
CORE += [arm.UC_ARM_REG_R12, arm.UC_ARM_REG_LR]
FLOATS = [arm.UC_ARM_REG_S0 + n for n in range(16)]
ALL = range(arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R12 + 1)
MOST = 1 << 30
KINDS = {READ: "read of", WRITE: "write of", ENTRY: "exception at", END: "end of the run, not"}


class Difference(Exception):
    """The first difference between the two cores."""


def wide(half):
    """Whether the instruction that begins with this halfword has 32 bits."""
    return half >> 11 in (0b11101, 0b11110, 0b11111)


def if_then(half):
    """Number of instructions in the block that this IT instruction begins; 0 if it is another."""
    if half >> 8 != 0xBF or half & 0xF == 0:
        return 0
    return 4 - (half & 0xF & -(half & 0xF)).bit_length() + 1


class Core:
    """The second core."""

    def __init__(self, image, events):
        self.image, self.events = image, events
        # The next event, and the next one that is not an access of the firmware.
        self.next = self.stop = 0
        # Retired instructions as the first core counts them, and those of the block that runs.
        self.count = self.pending = 0
        self.target, self.stepping = 0, False
        self.reads = self.writes = self.dac_stores = self.telemetry = self.ram = 0
        self.difference = self.returning = None
        # Of each active exception: its handler, and how many instructions too many had run.
        self.active = []
        self.private = {}
        # Executed blocks of code, with their numbers of instructions.
        self.blocks = {}
        self.uc = uc = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        uc.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M4)
        for begin, length in MEMORIES:
            uc.mem_map(begin, length)
        uc.mem_write(FLASH, b"\xff" * 0x200000)
        for address, offset, length in image.segments:
            uc.mem_write(address, image.data[offset : offset + length])
        for base, length in ((PERIPHERALS, 0x20000000), (PRIVATE, 0x100000)):
            uc.mmio_map(base, length, self._read, base, self._write, base)
        uc.hook_add(UC_HOOK_BLOCK, self._block)
        uc.hook_add(UC_HOOK_INTR, self._interrupt)

    def run(self):
        """Replays the trace. Raises `Difference`."""
        self._reset()
        for self.stop, event in enumerate(self.events):
            if event.kind in (READ, WRITE):
                continue
            self._run_to(event.count)
            if event.kind == ENTRY and self.events[self.next].count == event.count + 1:
                # An access that fails raises the exception, and its instruction does not retire.
                self._fail(self.events[self.next].address)
                self.next += 1
            if self.next < self.stop:
                self._differ(self.events[self.next], "no access")
            self.next = self.stop + 1
            if event.kind == ENTRY:
                self._enter(event)
            elif event.kind == RESET:
                self._reset()
            elif event.kind in (LOAD, HOST_WRITE):
                self.uc.mem_write(event.address, event.bytes)
            elif event.kind == HOST_READ:
                self._compare(event)

    # Surroundings.

    def _access(self, kind, address, size, value=0):
        """Takes an access from the trace and returns its value."""
        if self.difference:
            return 0
        event = self.events[self.next]
        found = f"{'read' if kind == READ else 'write'} of {size} bytes at {address:#010x}"
        if kind == WRITE:
            found += f", {value:#x}"
        made = (event.kind, event.address, event.size) == (kind, address, size)
        if not made or (kind == WRITE and event.value != value):
            self._note(event, found)
            return 0
        # Made by the block that runs.
        if not self.count < event.count <= self.count + self.pending:
            self._note(event, f"{found}, in a block from {self.count} instructions")
            return 0
        self.next += 1
        if kind == READ:
            self.reads += 1
        else:
            self.writes += 1
            self.dac_stores += address in DAC
        return event.value

    def _read(self, _, offset, size, base):
        address = base + offset
        if address in BIT_BAND:
            unit, bit = bit_band(address, size)
            return self._access(READ, unit, size) >> bit & 1
        if base == PRIVATE and address not in DBGMCU:
            return self._read_private(address, size)
        return self._access(READ, address, size)

    def _write(self, _, offset, size, value, base):
        address, value = base + offset, value & (1 << 8 * size) - 1
        if address in BIT_BAND:
            unit, bit = bit_band(address, size)
            before = self._access(READ, unit, size)
            self._access(WRITE, unit, size, before & ~(1 << bit) | (value & 1) << bit)
        elif base == PRIVATE and address not in DBGMCU:
            for n in range(size):
                self.private[address + n] = value >> 8 * n & 0xFF
        else:
            self._access(WRITE, address, size, value)

    def _read_private(self, address, size):
        """Registers in the core are not in the trace. They hold what was written, and 0 at first."""
        if address not in SYSTEM_CONTROL:
            return 0
        if address == ICSR and size == 4:
            # VECTACTIVE.
            return self.uc.reg_read(arm.UC_ARM_REG_IPSR)
        return sum(self.private.get(address + n, 0) << 8 * n for n in range(size))

    def _fail(self, address):
        """Fault registers after a failed access, B3.2.15 to B3.2.18. On a Cortex-M4, MMFAR and BFAR
        are one register."""
        words = ((CFSR, PRECISE), (HFSR, FORCED), (MMFAR, address), (BFAR, address))
        for register, word in words:
            for n in range(4):
                self.private[register + n] = word >> 8 * n & 0xFF

    def _compare(self, event):
        """Compares what the host read in RAM."""
        found = bytes(self.uc.mem_read(event.address, len(event.bytes)))
        if found != event.bytes:
            at = next(n for n, pair in enumerate(zip(found, event.bytes)) if pair[0] != pair[1])
            self._differ(event, f"{found[at]:#04x} at {event.address + at:#010x}", at)
        self.ram += len(found)
        block = self.image.symbols["_SEGGER_RTT"]
        (channels,) = struct.unpack("<I", self.uc.mem_read(block + 16, 4))
        for n in range(channels):
            buffer, size = struct.unpack("<II", self.uc.mem_read(block + 28 + 24 * n, 8))
            if buffer <= event.address and event.address + len(found) <= buffer + size:
                self.telemetry += len(found)

    def _note(self, event, found, at=0):
        """Notes a difference inside a callback of unicorn."""
        expected = f"{KINDS.get(event.kind, 'access of the host to')} {event.address:#010x}"
        if event.kind in (READ, WRITE):
            expected += f", {event.size} bytes, {event.value:#x}"
        elif event.bytes:
            expected = f"{event.bytes[at]:#04x} at {event.address + at:#010x}"
        pc = self.uc.reg_read(arm.UC_ARM_REG_PC)
        where = f"after {event.count} instructions, at {pc:#010x} in {self.image.name(pc)}"
        self.difference = self.difference or f"{where}: expected {expected}; found {found}"
        self.uc.emu_stop()

    def _differ(self, event, found, at=0):
        self._note(event, found, at)
        raise Difference(self.difference)

    # Execution.

    def _block(self, _, address, size, __):
        if self.stepping:
            return
        self.count += self.pending
        self.pending = self.blocks.get((address, size)) or self._length(address, size)
        if self.count + self.pending > self.target:
            self.pending = 0
            self.uc.emu_stop()

    def _length(self, address, size):
        """Number of instructions in a block. Those that an IT instruction skips count, too."""
        halves = struct.unpack(f"<{size // 2}H", self.uc.mem_read(address, size))
        at = number = 0
        while at < len(halves):
            at += 2 if wide(halves[at]) else 1
            number += 1
        self.blocks[address, size] = number
        return number

    def _interrupt(self, _, number, __):
        pc = self.uc.reg_read(arm.UC_ARM_REG_PC)
        if number == EXCEPTION_EXIT:
            self.returning = pc | 1
        else:
            self._note(self.events[self.next], f"exception {number} of unicorn")
        self.uc.emu_stop()

    def _start(self, count):
        pc = self.uc.reg_read(arm.UC_ARM_REG_PC)
        try:
            self.uc.emu_start(pc | 1, 0xFFFFFFFE, count=count)
        except UcError as error:
            self._note(self.events[self.next], str(error))
        self.count += self.pending
        self.pending = 0
        if self.difference:
            raise Difference(self.difference)
        if self.returning:
            self._return(self.returning)
            self.returning = None

    def _run_to(self, target):
        """Runs until so many instructions have retired. It may be up to four more: unicorn does not
        stop between the instructions that follow an IT instruction."""
        self.target = target
        while self.count < target:
            before = self.count
            self._start(MOST)
            if self.count == before:
                # The target is in the next block.
                self._step()

    def _step(self):
        pc = self.uc.reg_read(arm.UC_ARM_REG_PC)
        (half,) = struct.unpack("<H", self.uc.mem_read(pc, 2))
        self.stepping = True
        self.pending = 1 + if_then(half)
        self._start(1)
        self.stepping = False

    # Exceptions, Armv7-M manual B1.5.6 and B1.5.8. The frame's floating-point part is stored at once.

    def _reset(self):
        write = self.uc.reg_write
        for register in ALL:
            write(register, 0)
        stack, entry = struct.unpack("<II", self.uc.mem_read(FLASH, 8))
        write(arm.UC_ARM_REG_XPSR_NZCVQG, 1 << 24)
        for register in (arm.UC_ARM_REG_CONTROL, arm.UC_ARM_REG_PRIMASK, arm.UC_ARM_REG_FPSCR):
            write(register, 0)
        write(arm.UC_ARM_REG_BASEPRI, 0)
        write(arm.UC_ARM_REG_LR, 0xFFFFFFFF)
        write(arm.UC_ARM_REG_SP, stack)
        write(arm.UC_ARM_REG_PC, entry)
        self.active, self.private = [], {}

    def _enter(self, event):
        read, write = self.uc.reg_read, self.uc.reg_write
        pc = read(arm.UC_ARM_REG_PC)
        extra, self.count = self.count - event.count, event.count
        sp, xpsr = read(arm.UC_ARM_REG_SP), read(arm.UC_ARM_REG_XPSR)
        extended = read(arm.UC_ARM_REG_CONTROL) & FPCA
        frame = sp - (0x68 if extended else 0x20)
        aligned = frame & 4
        frame -= aligned
        words = [read(register) for register in CORE] + [pc, xpsr & ~(1 << 9) | aligned << 7]
        if extended:
            words += [read(register) for register in FLOATS] + [read(arm.UC_ARM_REG_FPSCR), 0]
        self.uc.mem_write(frame, struct.pack(f"<{len(words)}I", *words))
        # To Thread mode, or to the handler of another exception.
        back = 0xFFFFFFE1 if self.active else 0xFFFFFFE9
        write(arm.UC_ARM_REG_LR, back if extended else back | BASIC_FRAME)
        write(arm.UC_ARM_REG_SP, frame)
        write(arm.UC_ARM_REG_CONTROL, 0)
        write(arm.UC_ARM_REG_IPSR, event.number)
        write(arm.UC_ARM_REG_PC, event.address | 1)
        self.active.append(extra)

    def _return(self, to):
        read, write = self.uc.reg_read, self.uc.reg_write
        deep = len(self.active) > 1
        if not self.active or to | BASIC_FRAME != (0xFFFFFFF1 if deep else 0xFFFFFFF9):
            self._differ(self.events[self.next], f"a return from an exception to {to:#010x}")
        frame, extended = read(arm.UC_ARM_REG_SP), not to & BASIC_FRAME
        size = 0x68 if extended else 0x20
        words = struct.unpack(f"<{size // 4}I", self.uc.mem_read(frame, size))
        for register, word in zip(CORE, words):
            write(register, word)
        if extended:
            for register, word in zip(FLOATS, words[8:]):
                write(register, word)
            write(arm.UC_ARM_REG_FPSCR, words[24])
        write(arm.UC_ARM_REG_SP, frame + size + (words[7] >> 9 & 1) * 4)
        write(arm.UC_ARM_REG_XPSR_NZCVQG, words[7] & ~(1 << 9))
        write(arm.UC_ARM_REG_CONTROL, FPCA if extended else 0)
        write(arm.UC_ARM_REG_PC, words[6] | 1)
        self.count += self.active.pop()


def bit_band(address, size):
    """The unit and the bit in it that an alias in the bit-band region stands for."""
    offset = address - BIT_BAND.start
    byte = PERIPHERALS + (offset >> 5)
    unit = byte & ~(size - 1)
    return unit, (offset >> 2 & 7) + 8 * (byte - unit)
