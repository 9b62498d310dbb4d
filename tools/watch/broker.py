"""Samples from an MQTT broker: what has been written is acknowledged; what comes twice counts once."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from importlib.util import find_spec
from queue import Empty, SimpleQueue
from typing import Any
from urllib.parse import urlsplit

from ...model.errors import DataError
from ...scenarios.measured.times import find_times
from .sources import MACHINE, POLL, Row

#: Beginnings of addresses, and the port of each.
PORTS = {"mqtt": 1883, "mqtts": 8883}
#: Key of the number in a message that is one cell.
VALUE = "value"
#: Messages go at least once.
QOS = 1
#: While messages wait to be acknowledged, the next one is waited for so long [s]: brokers hold back all but some.
SOON = 0.02
#: Longest pause between two tries to reach the broker [s].
PATIENCE = 30


class Broker:
    """Messages of a topic, each a sample or a cell of one.

    Args:
        address: mqtt://USER:PASSWORD@HOST:PORT/TOPIC, mqtts for TLS; user, password and port may be left out
        session: name under which the broker keeps what comes while nobody is there; None without
        publish: topic under which events go out, that of their machine added; none if empty
        time: column of time by the card; "" where it names none

    Raises:
        DataError: the address is none, or paho-mqtt is not installed
    """

    def __init__(self, address: str, session: str | None, publish: str = "", time: str = "") -> None:
        scheme, _, rest = address.partition("://")
        where, _, self.topic = rest.partition("/")
        at = urlsplit(f"//{where}")
        try:
            self.host, self.port = at.hostname or "", at.port or PORTS[scheme]
        except ValueError:
            self.host = ""
        if not (self.host and self.topic):
            raise DataError(f"{address}: expected mqtt://HOST:PORT/TOPIC, such as mqtt://localhost/farm/+")
        if find_spec("paho") is None:
            raise DataError('MQTT needs paho-mqtt. Run pip install "gearheat[mqtt]".')
        from paho.mqtt.client import Client
        from paho.mqtt.enums import CallbackAPIVersion

        self.publish, self.time = publish, time
        self.client = Client(CallbackAPIVersion.VERSION2, session or "", clean_session=session is None, manual_ack=True)
        if at.username:
            self.client.username_pw_set(at.username, at.password)
        if scheme == "mqtts":
            self.client.tls_set()
        self.client.reconnect_delay_set(1, PATIENCE)
        self.client.on_connect, self.client.on_connect_fail = self._connected, self._failed
        self.client.on_disconnect, self.client.on_message = self._lost, self._came
        self._queue: SimpleQueue[Row | tuple[int, Any]] = SimpleQueue()
        #: Connections so far, and what has been given since it was acknowledged: number of the connection and message.
        self._connection, self._held = 0, list[tuple[int, Any]]()
        self._down = False

    def rows(self) -> Iterator[Row | None]:
        """Samples as they come."""
        self.client.connect_async(self.host, self.port)
        self.client.loop_start()
        try:
            while True:
                try:
                    came = self._queue.get(timeout=SOON if self._held else POLL)
                except Empty:
                    yield None
                    continue
                if isinstance(came, Row):
                    yield came
                else:
                    self._held.append(came)
                    yield self._row(came[1].topic, came[1].payload)
        finally:
            self.client.disconnect()
            self.client.loop_stop()

    def kept(self) -> None:
        """Acknowledge what came by the connection that there is; a broker that was lost sends the rest again."""
        for connection, message in self._held:
            if connection == self._connection:
                self.client.ack(message.mid, message.qos)
        self._held.clear()

    def tell(self, event: Mapping[str, Any], text: str) -> None:
        """Publish an event, which waits until the broker has it."""
        if not self.publish:
            return
        while True:
            sent = self.client.publish(f"{self.publish}/{event['machine']}", text, QOS, retain=False)
            try:
                sent.wait_for_publish()
                return
            except RuntimeError:  # there is no connection
                time.sleep(POLL)

    def _row(self, topic: str, payload: bytes) -> Row:
        """The sample of a message, or what is wrong with it."""
        where, (above, last) = f"topic {topic}", ["", *topic.split("/")][-2:]
        text = payload.decode("utf-8", errors="replace")
        try:
            cells = json.loads(text)
        except ValueError:
            cells = None
        if not isinstance(cells, dict) or not find_times(cells, self.time):
            wanted = '{"time_utc": ..., COLUMN: ...}, or in the topic of a column {"time_utc": ..., "value": ...}'
            return Row(last, {}, where, problem=f'{where}: "{text[:60]}" is no sample; expected {wanted}')
        if VALUE in cells:
            cells[last], last = cells.pop(VALUE), above
        return Row(str(cells.pop(MACHINE, "")) or last, cells, where)

    def _connected(self, client: Any, data: Any, flags: Any, reason: Any, properties: Any) -> None:
        if reason.is_failure:
            return self._told(f"refuses: {reason}")
        self._down = False
        client.subscribe(self.topic, QOS)

    def _lost(self, client: Any, data: Any, flags: Any, reason: Any, properties: Any) -> None:
        self._connection += 1
        self._told(f"connection lost ({reason})")

    def _failed(self, client: Any, data: Any) -> None:
        self._told("cannot be reached")

    def _told(self, what: str) -> None:
        if self._down:
            return
        self._down = True
        said = f"{self.host}:{self.port}: {what} at {datetime.now(UTC):%Y-%m-%dT%H:%MZ}; it is tried again"
        self._queue.put(Row("broker", {}, "", problem=said))

    def _came(self, client: Any, data: Any, message: Any) -> None:
        self._queue.put((self._connection, message))
