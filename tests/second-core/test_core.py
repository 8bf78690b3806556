"""Tests of the second core with short programs, whose results follow from the Armv7-M manual."""

import struct
import unittest

from unicorn import arm_const as arm

from core import FLASH, RAM, Core, Difference, bit_band, if_then
from inputs import END, ENTRY, HOST_READ, READ, WRITE, Event

HANDLER = FLASH + 0x200
STACK = RAM + 0x1000
REGISTER = 0x40000000


class Program:
    """What `Core` needs of an image: code from 0x100, and a handler that is a `bx lr` at its end."""

    def __init__(self, code, handler=(0x4770,)):
        data = bytearray(b"\xff" * 0x300)
        struct.pack_into("<II", data, 0, STACK, FLASH + 0x101)
        struct.pack_into(f"<{len(code)}H", data, 0x100, *code)
        struct.pack_into(f"<{len(handler)}H", data, 0x200, *handler)
        self.data = bytes(data)
        self.segments = [(FLASH, 0, len(data))]
        self.symbols = {"_SEGGER_RTT": RAM + 0x800}

    def name(self, _):
        return "program"


def entry(count, number=16):
    return Event(ENTRY, 0, number, HANDLER, 0, count)


def end(count):
    return Event(END, 0, 0, 0, 0, count)


def replay(program, *events):
    core = Core(program, list(events))
    core.run()
    return core


def register(core, n):
    return core.uc.reg_read(arm.UC_ARM_REG_R0 + n)


class CoreTest(unittest.TestCase):
    def test_instructions_in_an_it_block(self):
        # IT, ITT, ITTT, ITTTT: the lowest set bit of the mask ends the block; a NOP is none.
        halves = (0xBF08, 0xBF04, 0xBF02, 0xBF01, 0xBF0C, 0xBF00, 0x2000)
        self.assertEqual([if_then(half) for half in halves], [1, 2, 3, 4, 2, 0, 0])

    def test_skipped_instructions_count(self):
        # cmp r0, r0; itee eq; moveq r1, #1; movne r2, #1; movne r3, #1; adds r4, #1; adds r4, #1
        code = (0x4280, 0xBF0E, 0x2101, 0x2201, 0x2301, 0x3401, 0x3401, 0xE7FE)
        core = replay(Program(code), end(6))
        self.assertEqual([register(core, n) for n in range(1, 5)], [1, 0, 0, 1])
        self.assertEqual(core.count, 6)

    def test_an_exception_inside_an_it_block_keeps_the_count(self):
        # cmp r0, r0; itt eq; addeq r1, #1; addeq r2, #1; adds r4, #1 twice; the exception comes after
        # the third instruction, and two instructions of the handler follow: the sixth is an adds r4.
        code = (0x4280, 0xBF04, 0x3101, 0x3201, 0x3401, 0x3401, 0xE7FE)
        core = replay(Program(code, (0x3501, 0x4770)), entry(3), end(7))
        self.assertEqual([register(core, n) for n in (1, 2, 4, 5)], [1, 1, 1, 1])
        self.assertEqual(core.count, 7)

    def test_the_frame_of_an_exception(self):
        # movs r0, #7; cmp r0, r0; adds r4, #1
        core = replay(Program((0x2007, 0x4280, 0x3401, 0xE7FE)), entry(2, 20), end(2))
        self.assertEqual(core.uc.reg_read(arm.UC_ARM_REG_LR), 0xFFFFFFF9)
        self.assertEqual(core.uc.reg_read(arm.UC_ARM_REG_IPSR), 20)
        frame = struct.unpack("<8I", core.uc.mem_read(STACK - 0x20, 0x20))
        # r0 to r3, r12, lr after a reset, the next instruction, T with Z and C of an equal comparison.
        expected = (7, 0, 0, 0, 0, 0xFFFFFFFF, FLASH + 0x104, 0x61000000)
        self.assertEqual(frame, expected)

    def test_the_frame_is_aligned_to_8_bytes(self):
        # sub sp, #4; adds r4, #1
        program = Program((0xB081, 0x3401, 0xE7FE))
        core = replay(program, entry(1), end(1))
        self.assertEqual(core.uc.reg_read(arm.UC_ARM_REG_SP), STACK - 0x28)
        core = replay(program, entry(1), end(3))
        self.assertEqual(core.uc.reg_read(arm.UC_ARM_REG_SP), STACK - 4)

    def test_floating_point_registers_survive_a_handler(self):
        # vmov.f32 s0, #1.0; adds r4, #1. The handler: vmov.f32 s0, #2.0; bx lr
        program = Program((0xEEB7, 0x0A00, 0x3401, 0xE7FE), (0xEEB0, 0x0A00, 0x4770))
        core = replay(program, entry(1), end(2))
        self.assertEqual(core.uc.reg_read(arm.UC_ARM_REG_S0), 0x40000000)
        self.assertEqual(core.uc.reg_read(arm.UC_ARM_REG_LR), 0xFFFFFFE9)
        core = replay(program, entry(1), end(4))
        self.assertEqual(core.uc.reg_read(arm.UC_ARM_REG_S0), 0x3F800000)
        self.assertEqual(register(core, 4), 1)
        # The handler has not used them yet, so the frame of the next exception is without them.
        core = replay(program, entry(1, 16), entry(1, 17), end(1))
        self.assertEqual(core.uc.reg_read(arm.UC_ARM_REG_LR), 0xFFFFFFF1)

    def test_nested_exceptions_return_in_order(self):
        # adds r4, #1 twice. The handler: adds r5, #1; bx lr
        program = Program((0x3401, 0x3401, 0xE7FE), (0x3501, 0x4770))
        core = replay(program, entry(1, 16), entry(2, 17), end(2))
        self.assertEqual(core.uc.reg_read(arm.UC_ARM_REG_LR), 0xFFFFFFF1)
        core = replay(program, entry(1, 16), entry(2, 17), end(6))
        self.assertEqual((register(core, 4), register(core, 5)), (2, 2))
        self.assertEqual(core.uc.reg_read(arm.UC_ARM_REG_IPSR), 0)

    # movs r0, #1; lsls r0, #30; ldr r1, [r0]; adds r1, #1; str r1, [r0, #4]
    ACCESSES = (0x2001, 0x0780, 0x6801, 0x3101, 0x6041, 0xE7FE)

    def accesses(self, *changes):
        events = [
            Event(READ, 4, 0, REGISTER, 41, 3),
            Event(WRITE, 4, 0, REGISTER + 4, 42, 5),
            end(5),
        ]
        for n, change in changes:
            events[n] = events[n]._replace(**change)
        return replay(Program(self.ACCESSES), *events)

    def test_reads_come_from_the_trace_and_writes_are_compared(self):
        core = self.accesses()
        self.assertEqual((core.reads, core.writes, register(core, 1)), (1, 1, 42))
        changes = (
            (0, {"address": REGISTER + 8}),
            (0, {"size": 2}),
            (0, {"count": 9}),
            (1, {"value": 43}),
            (1, {"kind": READ}),
            (2, {"count": 4}),
        )
        for change in changes:
            with self.subTest(change), self.assertRaises(Difference):
                self.accesses(change)

    def test_an_access_too_many_and_one_too_few_are_differences(self):
        with self.assertRaisesRegex(Difference, "found read of 4 bytes at 0x40000000"):
            replay(Program(self.ACCESSES), end(5))
        with self.assertRaisesRegex(Difference, "found no access"):
            replay(Program((0x3401, 0xE7FE)), Event(READ, 4, 0, REGISTER, 0, 1), end(1))

    def test_ram_is_compared(self):
        # movs r0, #1; lsls r0, #29; movs r1, #5; str r1, [r0]
        program = Program((0x2001, 0x0740, 0x2105, 0x6001, 0xE7FE))
        seen = Event(HOST_READ, 0, 0, RAM, 4, 4, b"\5\0\0\0")
        self.assertEqual(replay(program, seen, end(4)).ram, 4)
        with self.assertRaisesRegex(Difference, "expected 0x01 at 0x20000002; found 0x00"):
            replay(program, seen._replace(bytes=b"\5\0\1\0"), end(4))

    def test_bit_band_alias(self):
        # Armv7-M: alias + 32 * byte + 4 * bit. Bit 3 of the byte at 0x40020001, as a word: bit 11.
        self.assertEqual(bit_band(0x42000000 + 0x20001 * 32 + 12, 4), (0x40020000, 11))


if __name__ == "__main__":
    unittest.main()
