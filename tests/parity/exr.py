# SPDX-License-Identifier: GPL-3.0-or-later
"""Read and write plain OpenEXR pictures with numpy alone.

Reads single-part scanline files of half and float channels without compression or with ZIP/ZIPS;
other compressions go through `oiiotool` where it is installed. Writes half-float ZIP with no
attributes but the required ones. Pixels are float32 arrays, height x width x 3, first row on top,
scene-linear.
"""

import shutil
import struct
import subprocess
import tempfile
import zlib
from pathlib import Path

import numpy

MAGIC = 20000630
NO_COMPRESSION, ZIPS, ZIP = 0, 2, 3
LINES_PER_BLOCK = {NO_COMPRESSION: 1, ZIPS: 1, ZIP: 16}
HALF, FLOAT = 1, 2
DTYPE = {HALF: "<f2", FLOAT: "<f4"}
TILED_OR_MULTIPART = 0x200 | 0x800 | 0x1000  # bits of the version field


def read(path, layer=None):
    """RGB of a file; `layer` names a layer of a multi-layer file, by default the Combined one."""
    data = Path(path).read_bytes()
    magic, version = struct.unpack_from("<II", data)
    if magic != MAGIC:
        raise ValueError(f"{path}: not an OpenEXR file")
    attributes, offset = read_header(data)
    if version & TILED_OR_MULTIPART or attributes["compression"][0] not in LINES_PER_BLOCK:
        return read_converted(path, layer)
    planes = read_planes(data, offset, attributes)
    return numpy.stack([planes[name] for name in rgb_names(path, planes, layer)], axis=-1)


def rgb_names(path, planes, layer):
    prefixes = [f"{layer}."] if layer else [""]
    if not layer:
        prefixes += sorted(name[:-1] for name in planes if name.endswith("Combined.R"))
    for prefix in prefixes:
        names = [prefix + channel for channel in "RGB"]
        if all(name in planes for name in names):
            return names
    raise ValueError(f"{path}: no RGB channels among {', '.join(sorted(planes))}")


def read_converted(path, layer):
    tool = shutil.which("oiiotool")
    if tool is None:
        raise ValueError(f"{path}: tiled, or compressed so that oiiotool is needed (not found)")
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / "plain.exr"
        subprocess.run([tool, str(path), "--compression", "zip", "--scanline", "-d", "float",
                        "-o", str(plain)], check=True)
        return read(plain, layer)


def read_string(data, offset):
    end = data.index(b"\0", offset)
    return data[offset:end].decode("ascii"), end + 1


def read_header(data):
    """Attributes as raw bytes by name, and the offset behind the header."""
    attributes, offset = {}, 8
    while data[offset]:
        name, offset = read_string(data, offset)
        _, offset = read_string(data, offset)
        size, = struct.unpack_from("<i", data, offset)
        attributes[name] = data[offset + 4:offset + 4 + size]
        offset += 4 + size
    return attributes, offset + 1


def parse_channels(raw):
    """Names and pixel types, in the file's order."""
    channels, offset = [], 0
    while raw[offset]:
        name, offset = read_string(raw, offset)
        kind, = struct.unpack_from("<i", raw, offset)
        if kind not in DTYPE:
            raise ValueError(f"channel {name}: integer channels are not supported")
        channels.append((name, kind))
        offset += 16
    return channels


def read_planes(data, offset, attributes):
    """All channels as float32 planes by name."""
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels = parse_channels(attributes["channels"])
    compression = attributes["compression"][0]
    lines = LINES_PER_BLOCK[compression]
    planes = {name: numpy.empty((height, width), numpy.float32) for name, _ in channels}
    for block in struct.unpack_from(f"<{-(-height // lines)}Q", data, offset):
        first, size = struct.unpack_from("<ii", data, block)
        raw = data[block + 8:block + 8 + size]
        rows = range(first - y0, min(first - y0 + lines, height))
        plain_size = len(rows) * width * sum(2 if kind == HALF else 4 for _, kind in channels)
        if compression != NO_COMPRESSION and size < plain_size:
            raw = decompress(raw)
        position = 0
        for row in rows:
            for name, kind in channels:
                planes[name][row] = numpy.frombuffer(raw, DTYPE[kind], width, position)
                position += width * (2 if kind == HALF else 4)
    return planes


def decompress(raw):
    """Undo ZIP: inflate, running sum, interleave the two halves."""
    deltas = numpy.frombuffer(zlib.decompress(raw), numpy.uint8).astype(numpy.int64)
    deltas[1:] -= 128
    split = (numpy.cumsum(deltas) & 255).astype(numpy.uint8)
    middle = (len(split) + 1) // 2
    plain = numpy.empty_like(split)
    plain[0::2], plain[1::2] = split[:middle], split[middle:]
    return plain.tobytes()


def compress(plain):
    """ZIP a block; returned as it is where that is not smaller, as the format asks."""
    values = numpy.frombuffer(plain, numpy.uint8)
    split = numpy.concatenate([values[0::2], values[1::2]]).astype(numpy.int64)
    split[1:] = (numpy.diff(split) + 128) & 255
    packed = zlib.compress(split.astype(numpy.uint8).tobytes(), 9)
    return packed if len(packed) < len(plain) else plain


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def write(path, pixels):
    """Write an RGB picture as half floats, ZIP, without any metadata."""
    height, width, _ = pixels.shape
    channels = b"".join(name + b"\0" + struct.pack("<iB3xii", HALF, 0, 1, 1)
                        for name in (b"B", b"G", b"R"))
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = struct.pack("<II", MAGIC, 2) + b"".join([
        attribute("channels", "chlist", channels + b"\0"),
        attribute("compression", "compression", bytes([ZIP])),
        attribute("dataWindow", "box2i", window), attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"),
        attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0.0, 0.0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1.0))]) + b"\0"
    planar = numpy.ascontiguousarray(pixels[:, :, ::-1].transpose(0, 2, 1)).astype("<f2")
    blocks = []
    for first in range(0, height, LINES_PER_BLOCK[ZIP]):
        packed = compress(planar[first:first + LINES_PER_BLOCK[ZIP]].tobytes())
        blocks.append(struct.pack("<ii", first, len(packed)) + packed)
    start = len(header) + 8 * len(blocks)
    offsets = [start + sum(map(len, blocks[:index])) for index in range(len(blocks))]
    Path(path).write_bytes(header + struct.pack(f"<{len(offsets)}Q", *offsets) + b"".join(blocks))
