# SPDX-License-Identifier: BSD-3-Clause
"""Drives `shearwake serve` (docs/reference/serve.md) for several clients."""
import asyncio
import contextlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from ..engine import Engine
from ..errors import ProgramError

Deliver = Callable[[dict, bytes], None]


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
        self.wake = asyncio.Event()
        self.task: Any = None  # asyncio.Task once started
        self.first: tuple[str, tuple[dict, bytes]] | None = None  # the job with which pages begin, and its answer

    async def start(self) -> None:
        self.task = asyncio.create_task(self.work())

    async def close(self) -> None:
        self.task.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await self.task
        await asyncio.to_thread(self.engine.close)

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
            with contextlib.suppress(ProgramError):  # answer() reports that the process has ended
                await asyncio.to_thread(self.engine.cancel)

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

    async def prepare(self, job: str) -> None:
        """Computes the job with which pages begin."""
        self.first = job, await self.answer(job)

    async def answer(self, job: str) -> tuple[dict, bytes]:
        if self.first and self.first[0] == job and self.first[1][0]["type"] == "result":
            return self.first[1]
        try:
            return await asyncio.to_thread(self.engine.request, job)
        except ProgramError:
            return {"type": "error", "code": "ended", "message": "the engine has ended; the next request starts it again"}, b""
