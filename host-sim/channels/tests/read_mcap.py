"""Reads an MCAP file of `cargo export` with the reader of the format's authors.

Usage: python host-sim/channels/tests/read_mcap.py run.mcap run.csv

Needs the packages mcap and mcap-protobuf-support. Checks that every channel has a schema, that there is a
message for each row of the recording, and that its columns have the values of the recording.
"""

import csv
import sys

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

COLUMNS = {"/velocity": ["true_omega"], "/current": ["current", "current_small"]}


def main(mcap_path, csv_path):
    with open(csv_path, newline="") as file:
        lines = (line for line in file if not line.startswith("#"))
        rows = list(csv.DictReader(lines))
    with open(mcap_path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        for channel in summary.channels.values():
            schema = summary.schemas[channel.schema_id]
            assert schema.encoding == "protobuf" and schema.data, channel.topic
        topics = {}
        for _, channel, message, decoded in reader.iter_decoded_messages():
            topics.setdefault(channel.topic, []).append((message.log_time, decoded))
    estimates = topics["/estimates"]
    assert len(estimates) == len(rows), (len(estimates), len(rows))
    compared = 0
    for (time_ns, estimate), row in zip(estimates, rows):
        assert abs(time_ns - round(float(row["t"]) * 1e9)) <= 1, row["t"]
        assert estimate.HasField("finite_difference"), row["t"]
    for topic, columns in COLUMNS.items():
        for column in columns:
            if column not in rows[0]:
                continue
            for (_, decoded), row in zip(topics[topic], rows, strict=True):
                assert getattr(decoded, column) == float(row[column]), (column, row["t"])
                compared += 1
    print(f"{len(rows)} rows, {len(topics)} topics, {compared} values compared: {sorted(topics)}")
    assert compared > 0


main(*sys.argv[1:])
