"""A writer in 40 lines: writes points from lines of "x y z" as a spmesh stream, for spfinalize and others.

    python3 writer.py < POINTS > STREAM

END is written last, and only if nothing failed before: a stream without END is never taken for a whole one."""
import struct, sys

def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def record(tag, payload):
    return tag + struct.pack("<I", len(payload)) + payload


def block(tag, payload):
    global sequence
    frame = struct.pack("<4sII", tag, sequence, len(payload))
    sequence = (sequence + 1) % 2**32
    sys.stdout.buffer.write(frame + struct.pack("<I", crc32c(frame + payload)) + payload)


# f64 coordinates, 2 dimensions with an elevation, no flags, no features, an unknown number of points.
body = struct.pack("<BBBBIQ", 1, 2, 1, 0, 0, 2**64 - 1) + record(b"prod", b"writer.py")
head = b"\x89SPM\r\n\x1a\n" + struct.pack("<HHI", 2, 1, len(body)) + body
sys.stdout.buffer.write(head + struct.pack("<I", crc32c(head)))
sequence, count, points = 0, 0, []
for line in sys.stdin:
    points.append(struct.pack("<3d", *map(float, line.split())))
    count += 1
    if len(points) == 2000:  # 48,000 bytes; a block has at most 2^20.
        block(b"PNTS", b"".join(points))
        points = []
block(b"PNTS", b"".join(points))
block(b"END ", struct.pack("<7Q", count, 0, 0, 0, 0, 0, 0))
