# SPDX-License-Identifier: BSD-3-Clause
"""Drives `shearwake serve` (docs/reference/serve.md) for several clients."""
import asyncio
import contextlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

LONGEST_LINE_B = 1 << 22  # of a message without its arrays: errors repeat parts of the job


Deliver = Callable[[dict, bytes], None]


class EngineEnded(Exception):
    """The process has ended."""


class Engine:
    """One process of `shearwake serve`."""

    def __init__(self, command: Sequence[str], environment: Mapping[str, str] | None = None) -> None:
        self.command, self.environment = command, environment
        self.process: Any = None  # asyncio.subprocess.Process once started
        self.hello: dict = {}

    async def start(self) -> None:
        self.process = await asyncio.create_subprocess_exec(
            *self.command, stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE, limit=LONGEST_LINE_B,
            env=self.environment, start_new_session=True)
        self.hello, _ = await self.receive()

    async def close(self) -> None:
        """Ends the process by closing its input."""
        if self.process is None or self.process.returncode is not None:
            return
        self.process.stdin.close()
        try:
            await asyncio.wait_for(self.process.wait(), 10)
        except asyncio.TimeoutError:
            self.process.kill()
            await self.process.wait()

    async def send(self, **message: Any) -> None:
        with contextlib.suppress(ConnectionError):  # receive() reports that the process has ended
            self.process.stdin.write(json.dumps(message).encode() + b"\n")
            await self.process.stdin.drain()

    async def receive(self) -> tuple[dict, bytes]:
        """The next message and the bytes of its arrays. Raises EngineEnded."""
        try:
            line = await self.process.stdout.readline()
            message = json.loads(line)
            return message, await self.process.stdout.readexactly(message.get("bytes", 0))
        except (ValueError, asyncio.IncompleteReadError):
            raise EngineEnded from None


@dataclass
class Client:
    """Someone who waits for results. `deliver(message, arrays)` must not block."""

    deliver: Deliver
    waiting: tuple | None = None  # its newest request (id, job) that is not active
    accepted: set = field(default_factory=set)  # the last job that the engine has computed


class Desk:
    """Computes the newest request of each client in turn."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine
        self.clients: list[Client] = []
        self.active: Client | None = None
        self.number = 0
        self.wake = asyncio.Event()
        self.task: Any = None  # asyncio.Task once started

    async def start(self) -> None:
        await self.engine.start()
        self.task = asyncio.create_task(self.work())

    async def close(self) -> None:
        self.task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await self.task
        await self.engine.close()

    def join(self, deliver: Deliver) -> Client:
        client = Client(deliver)
        self.clients.append(client)
        return client

    async def leave(self, client: Client) -> None:
        client.waiting = None
        self.clients.remove(client)
        await self.cancel(client)

    async def cancel(self, client: Client) -> None:
        """Ends the active request of the client."""
        if self.active is client:
            await self.engine.send(type="cancel")

    async def compute(self, client: Client, number: int, job: str) -> None:
        if client.waiting:
            client.deliver({"type": "cancelled", "id": client.waiting[0], "reason": "a newer request has arrived"}, b"")
        client.waiting = (number, job)
        self.wake.set()
        await self.cancel(client)

    def next_client(self) -> Client | None:
        """The first client that waits, which then becomes the last."""
        for client in self.clients:
            if client.waiting:
                self.clients.remove(client)
                self.clients.append(client)
                return client
        return None

    async def work(self) -> None:
        while True:
            client = self.next_client()
            if client is None or client.waiting is None:
                self.wake.clear()
                await self.wake.wait()
                continue
            request, client.waiting = client.waiting, None
            self.active = client
            message, arrays = await self.answer(request[1])
            self.active = None
            if message["type"] == "result":
                client.accepted = {request[1]}
            client.deliver({**message, "id": request[0]}, arrays)

    async def answer(self, job: str) -> tuple[dict, bytes]:
        self.number += 1
        await self.engine.send(type="compute", id=self.number, job=job)
        try:
            while True:
                message, arrays = await self.engine.receive()
                if message.get("id", self.number) == self.number:
                    return message, arrays
        except EngineEnded:
            await self.engine.close()
            await self.engine.start()
            return {"type": "error", "code": "ended", "message": "the engine has ended and was started again"}, b""
