"""Reads a session file with the official Python reader, and validates every message against its schema.

Run by `cargo xtask test --only session-readers`, with the counts that the writer has:
python_reader.py FILE MESSAGES ENTRIES
"""

import json
import sys
from collections import Counter

import jsonschema
from mcap.reader import SeekingReader, make_reader
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory


def main(path, messages_expected, frames_expected):
    validators = {}
    topics = Counter()
    frames = 0
    with open(path, "rb") as file:
        # With a decoder of another encoding beside: it must leave JSON alone.
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert isinstance(reader, SeekingReader), "the file has no summary"
        summary = reader.get_summary()
        last = 0
        for schema, channel, message in reader.iter_messages():
            if channel.topic == "/state":
                # For replays by MotorLink only.
                assert (schema, channel.message_encoding) == (None, "motorlink-state"), channel
                topics[channel.topic] += 1
                continue
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json"), channel
            if schema.id not in validators:
                definition = json.loads(schema.data)
                jsonschema.Draft202012Validator.check_schema(definition)
                # Foxglove asks for an object at the top.
                assert definition["type"] == "object", schema.name
                validators[schema.id] = jsonschema.Draft202012Validator(definition)
            value = json.loads(message.data)
            validators[schema.id].validate(value)
            undeclared = set(value) - set(validators[schema.id].schema["properties"])
            assert not undeclared, undeclared
            assert message.log_time >= last, "messages by time"
            last = message.log_time
            topics[channel.topic] += 1
            frames += len(value.get("frames", []))
        attachments = {one.name: one.data for one in reader.iter_attachments()}
        metadata = {one.name: one.metadata for one in reader.iter_metadata()}
    assert metadata["motorlink"]["version"] == "1", metadata
    assert topics["/odom"] and topics["/cmd_vel"], topics
    assert json.loads(metadata["motorlink"]["rover"])["wheel_radius_mm"] == 50, metadata
    json.loads(attachments["overview.json"])
    runs = [json.loads(data) for name, data in attachments.items() if name.startswith("run-")]
    assert [(len(run["samples"]), len(run["sent"])) for run in runs] == [(50, 1)], runs
    counts = {summary.channels[number].topic: count
              for number, count in summary.statistics.channel_message_counts.items() if count}
    assert counts == dict(topics), (counts, topics)
    total = sum(topics.values())
    assert (total, frames) == (messages_expected, frames_expected), (total, frames)
    with open(path, "rb") as file:
        records = sum(1 for _ in StreamReader(file, validate_crcs=True).records)
    assert records > total
    print(f"{total} messages with {frames} frames are valid: {dict(topics)}")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
