"""What tests of live pages share: a browser that sees no picture, but what is sent to one and what one says."""

import threading
import time

import msgspec
import numpy as np
import viser
import zstandard
from viser import _messages
from websockets.sync.client import connect

WAIT = 20.0  # seconds, at most, for what happens at once


def until(happened, what):
    """Wait for something to happen."""
    end = time.monotonic() + WAIT
    while not happened():
        assert time.monotonic() < end, f"waited in vain for {what}"
        time.sleep(0.01)


class Browser:
    """A browser on a page: what it was sent, and what its user does."""

    def __init__(self, url, width=9, height=9):
        self._socket = connect(
            url.replace("http", "ws"), origin=url, subprotocols=[f"viser-v{viser.__version__}"], max_size=None
        )
        self.nodes, self.gui, self.camera = {}, {}, []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self.look((0, 0, 1), width, height)

    def look(self, position, width, height):
        self.say(
            _messages.ViewerCameraMessage(
                (1, 0, 0, 0), tuple(position), 1, 0.1, 10, height, width, (0, 0, 0), (0, 0, 1)
            )
        )

    def say(self, message):
        self._socket.send(msgspec.msgpack.encode(message.as_serializable_dict()))

    def close(self):
        self._socket.close()
        self._reader.join()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    @property
    def words(self):
        return " ".join(m["props"].get("_markdown", "") for m in list(self.gui.values()))

    def has(self, label):
        return self.find(label) is not None

    def find(self, label):
        found = [uuid for uuid, m in list(self.gui.items()) if m["props"].get("label") == label]
        return found[0] if found else None

    def press(self, label):
        until(lambda: self.has(label), f"a button {label!r}")
        self.set(label, True)

    def set(self, label, value):
        until(lambda: self.has(label), f"a control {label!r}")
        self.gui[self.find(label)]["value"] = value  # what one says is not said back
        self.say(_messages.GuiUpdateMessage(self.find(label), {"value": value}))

    def value(self, label):
        return self.gui[self.find(label)]["value"]

    def drag(self, node, instance, phase, start, end):
        self.say(_messages.SceneNodeDragMessage(phase, node, instance, start, (0, 0), end, (0, 0), "left", None))

    def _read(self):
        for raw in self._socket:
            size, packed = (int.from_bytes(raw[k : k + 8], "little") for k in (0, 8))
            window = msgspec.msgpack.decode(zstandard.ZstdDecompressor().decompress(raw[16 : 16 + packed], size))
            place, self._buffers = 16 + packed, []
            for length in window["binaryBufferLengths"]:
                place += -place % 8
                self._buffers.append(raw[place : place + length])
                place += length
            for message in window["messages"]:
                self._take(message)

    def _take(self, message):
        updates = {key: self._array(value) for key, value in message.get("updates", {}).items()}
        if message["type"] == "GuiUpdateMessage" and message["uuid"] in self.gui:
            self.gui[message["uuid"]]["value"] = updates.pop("value", self.gui[message["uuid"]].get("value"))
            self.gui[message["uuid"]]["props"].update(updates)
        elif message["type"] == "SceneNodeUpdateMessage":
            self.nodes[message["name"]].update(updates)
        elif message["type"] == "SetSceneNodeVisibilityMessage" and message["name"] in self.nodes:
            self.nodes[message["name"]]["visible"] = message["visible"]
        elif message["type"] == "RemoveSceneNodeMessage":
            self.nodes.pop(message["name"], None)
        elif message["type"] == "SetCameraPositionMessage":
            self.camera.append(np.array(message["position"]))
        elif "props" in message and "uuid" in message:
            self.gui[message["uuid"]] = message
        elif "props" in message:
            self.nodes[message["name"]] = {key: self._array(value) for key, value in message["props"].items()}

    def _array(self, value):
        if isinstance(value, dict) and "__binary_index" in value:
            return np.frombuffer(self._buffers[value["__binary_index"]], dtype=value["dtype"])
        return value
