#!/usr/bin/env python3
"""Replays a run of the emulated board on another emulator's core and compares them.

Exit status: 0 if every access and every compared byte is equal; 1 at the first difference; 2 if an
input cannot be used.
"""

import argparse
import sys

import inputs


def parse():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("image", help="ELF file of the image")
    parser.add_argument("trace", help="file that cargo board --trace has written")
    parser.add_argument(
        "--self-test",
        action="store_true",
        help="also replay changed traces and images, and check that each change is found",
    )
    return parser.parse_args()


def main():
    arguments = parse()
    try:
        from core import Core, Difference
    except ImportError:
        print("replay.py: no module unicorn; run pip install unicorn==2.1.4", file=sys.stderr)
        return 2
    try:
        image = inputs.Image(arguments.image)
        events = inputs.read_trace(arguments.trace, inputs.fnv1a(image.data))
    except inputs.Unusable as error:
        print(f"replay.py: {error}", file=sys.stderr)
        return 2
    core = Core(image, events)
    try:
        core.run()
    except Difference as difference:
        print(difference)
        return 1
    print(
        f"{core.count} instructions, {core.reads} register reads, {core.writes} writes, "
        f"{core.dac_stores} DAC stores, {core.telemetry} telemetry bytes, "
        f"{core.ram} bytes of RAM: equal"
    )
    if arguments.self_test:
        import self_test

        return self_test.run(image, events, core)
    return 0


if __name__ == "__main__":
    sys.exit(main())
