"""Checks that the replay finds changes: of the trace, and of single instructions of the image."""

import struct

from core import DAC, Core, Difference
from inputs import HOST_READ, READ, WRITE, Image

# Instructions whose first and second halfword under the mask are the value; what is changed in them.
PATCHES = (
    ("vadd.f32 to vsub.f32", (0xFFB0, 0x0F50), (0xEE30, 0x0A00), (0, 0x0040)),
    ("vmul.f32 to vnmul.f32", (0xFFB0, 0x0F50), (0xEE20, 0x0A00), (0, 0x0040)),
    ("vcvt.f32.s32 to vcvt.f32.u32", (0xFFBF, 0x0FD0), (0xEEB8, 0x0AC0), (0, 0x0080)),
)
# Of each kind so many places, spread over the executed ones.
PLACES = 8


def difference(image, events):
    """The first difference of a replay, or None."""
    try:
        Core(image, events).run()
    except Difference as found:
        return str(found)
    return None


def changed(event):
    """The event with its lowest bit changed."""
    if event.bytes:
        return event._replace(bytes=bytes([event.bytes[0] ^ 1]) + event.bytes[1:])
    return event._replace(value=event.value ^ 1)


def places(core, mask, value):
    """Addresses of executed instructions of this form."""
    found = set()
    for address, size in core.blocks:
        offset = core.image.offset(address)
        if offset is None:
            continue
        halves = struct.unpack_from(f"<{size // 2}H", core.image.data, offset)
        for n, pair in enumerate(zip(halves, halves[1:])):
            if tuple(half & bits for half, bits in zip(pair, mask)) == value:
                found.add(address + 2 * n)
    return sorted(found)


def run(image, events, core):
    """Prints a line for each change; 0 if every one of the trace and one changed instruction at least are
    found: some have no effect in a run."""
    failed = False
    kinds = (
        ("a store to the DAC", lambda event: event.kind == WRITE and event.address in DAC),
        ("a store to another register", lambda event: event.kind == WRITE),
        ("the address of a read", lambda event: event.kind == READ),
        ("a byte that the host read", lambda event: event.kind == HOST_READ),
    )
    for name, wanted in kinds:
        which = [n for n, event in enumerate(events) if wanted(event)]
        if not which:
            print(f"self-test: {name}: not in this trace")
            continue
        # One near the end, so that what comes before it is still equal.
        n = which[len(which) * 9 // 10]
        event = events[n]
        other = event._replace(address=event.address ^ 4) if event.kind == READ else changed(event)
        found = difference(image, events[:n] + [other] + events[n + 1 :])
        exact = found is not None and f"after {event.count} instructions" in found
        failed |= not exact
        print(f"self-test: {name}: {found or 'NOT FOUND'}{'' if exact else ', NOT THE CHANGE'}")
    effective = 0
    for name, mask, value, change in PATCHES:
        at = places(core, mask, value)
        if not at:
            print(f"self-test: {name}: not in what was executed")
            continue
        chosen = at[:: -(-len(at) // PLACES)]
        found = 0
        for address in chosen:
            data = bytearray(image.data)
            for n, bits in enumerate(change):
                offset = image.offset(address) + 2 * n
                (half,) = struct.unpack_from("<H", data, offset)
                struct.pack_into("<H", data, offset, half ^ bits)
            text = difference(Image("", bytes(data)), events)
            found += text is not None
            print(f"self-test: {name} at {address:#010x}: {text or 'no effect in this run'}")
        print(f"self-test: {name}: {found} of {len(chosen)} found, {len(at)} places executed")
        effective += found
    failed |= effective == 0
    print(f"self-test: {'FAILED' if failed else 'passed'}")
    return 1 if failed else 0
