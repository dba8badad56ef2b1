# SPDX-License-Identifier: BSD-3-Clause
"""The server of the page: one document and one WebSocket, reachable from this machine only.

Every request needs the token, as a query parameter or as the cookie that the first visit sets. The header Host must name this
server, so that no other name can be bound to this address, and a WebSocket also needs the header Origin of the page. The
server opens no file that a request names: jobs are passed to the program, which accepts no names of files from `serve`."""
import asyncio
import contextlib
import hmac
import json
from collections.abc import Callable

from aiohttp import WSMsgType, web

import shearwake

from . import page
from .engine import Client, Desk
from .sweeps import NotASweep, Sweeps

LONGEST_MESSAGE_B = 900_000  # below the limit of serve, also after quoting
MOST_CLIENTS = 16
HEADERS = {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer", "Cache-Control": "no-store",
           "X-Frame-Options": "DENY", "Cross-Origin-Resource-Policy": "same-origin"}


class Outbox:
    """The messages to one page. Of the results that it has not received yet, it keeps the newest only."""

    def __init__(self, socket: web.WebSocketResponse) -> None:
        self.socket = socket
        self.messages: list[dict] = []
        self.result: tuple[dict, bytes] | None = None
        self.wake = asyncio.Event()

    def put(self, message: dict, arrays: bytes = b"") -> None:
        if message["type"] == "result":
            self.result = (message, arrays)
        else:
            self.messages = [*self.messages[-50:], message]
        self.wake.set()

    async def send_all(self) -> None:
        while True:
            await self.wake.wait()
            self.wake.clear()
            while self.messages:
                await self.socket.send_str(json.dumps(self.messages.pop(0)))
            if self.result:
                (message, arrays), self.result = self.result, None
                await self.socket.send_str(json.dumps(message))
                await self.socket.send_bytes(arrays)


class Explorer:
    def __init__(self, engine: shearwake.Engine, token: str, folder: str, keys: dict[str, dict], public_port: int = 0) -> None:
        self.desk, self.sweeps, self.token, self.keys = Desk(engine), Sweeps(folder), token, keys
        self.port = 0  # set when the server listens
        self.public_port = public_port  # to which the browser connects, if it is another one
        self.sockets: set[web.WebSocketResponse] = set()

    def application(self) -> web.Application:
        app = web.Application(middlewares=[self.guard], client_max_size=1)
        app.router.add_get("/", self.show_page)
        app.router.add_get("/socket", self.talk)
        app.router.add_get(r"/report/{number:\d{1,4}}", self.show_report)
        app.on_startup.append(lambda _: self.desk.start())
        app.on_shutdown.append(lambda _: self.end())
        return app

    async def end(self) -> None:
        for socket in list(self.sockets):
            await socket.close()
        await self.sweeps.close()
        await self.desk.close()

    @property
    def hosts(self) -> set[str]:
        ports = {self.port, self.public_port or self.port}
        return {f"{name}:{port}" for name in ("127.0.0.1", "localhost", "[::1]") for port in ports}

    @property
    def cookie(self) -> str:
        return f"shearwake_{self.port}"

    @web.middleware
    async def guard(self, request: web.Request, handler: Callable) -> web.StreamResponse:
        try:
            if request.headers.get("Host") not in self.hosts:
                raise web.HTTPForbidden(text="the header Host is not that of this server; if its port is forwarded, start shearwake explore "
                                             "with --public-port and the port of the browser\n")
            given = request.query.get("token") or request.cookies.get(self.cookie) or ""
            if not hmac.compare_digest(given.encode("utf-8", "surrogateescape"), self.token.encode()):
                raise web.HTTPForbidden(text="the token is missing or wrong; use the address that shearwake explore prints\n")
            response = await handler(request)
        except web.HTTPException as error:
            error.headers.update(HEADERS)
            raise
        if not response.prepared:
            response.headers.update(HEADERS)
        return response

    async def show_page(self, request: web.Request) -> web.Response:
        text, policy = page.document({"limits": self.desk.engine.hello.get("limits", {}), **self.keys})
        response = web.Response(text=text, content_type="text/html", headers={"Content-Security-Policy": policy})
        response.set_cookie(self.cookie, self.token, httponly=True, samesite="Strict", path="/")
        return response

    async def show_report(self, request: web.Request) -> web.Response:
        try:
            text = await asyncio.to_thread(self.sweeps.report, int(request.match_info["number"]))
        except shearwake.ProgramError as error:
            raise web.HTTPInternalServerError(text=f"{error}\n") from error
        if text is None:
            raise web.HTTPNotFound(text="this server has run no such sweep\n")
        policy = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'"
        return web.Response(text=text, content_type="text/html", headers={"Content-Security-Policy": policy})

    async def talk(self, request: web.Request) -> web.WebSocketResponse:
        if request.headers.get("Origin") not in {f"http://{host}" for host in self.hosts}:
            raise web.HTTPForbidden(text="the header Origin is not that of this server\n")
        if len(self.sockets) >= MOST_CLIENTS:
            raise web.HTTPServiceUnavailable(text=f"{MOST_CLIENTS} pages are open; close one of them\n")
        socket = web.WebSocketResponse(max_msg_size=LONGEST_MESSAGE_B, heartbeat=30, compress=False)
        await socket.prepare(request)
        self.sockets.add(socket)
        outbox = Outbox(socket)
        client = self.desk.join(outbox.put)
        sender = asyncio.create_task(outbox.send_all())
        try:
            async for received in socket:
                if received.type == WSMsgType.TEXT:
                    await self.handle(received.data, client, outbox)
                elif received.type == WSMsgType.BINARY:
                    outbox.put({"type": "error", "code": "bad_request", "message": "a request must be a text"})
        finally:
            self.sockets.discard(socket)
            await self.desk.leave(client)
            sender.cancel()
            with contextlib.suppress(asyncio.CancelledError, ConnectionError):
                await sender
        return socket

    async def handle(self, text: str, client: Client, outbox: Outbox) -> None:
        """Answers one message of a page."""
        def refuse(message: str, number: int | None = None) -> None:
            outbox.put({"type": "error", "code": "bad_request", "message": message, **({} if number is None else {"id": number})})

        try:
            message = json.loads(text)
        except (ValueError, RecursionError):
            return refuse("the request is not valid JSON")
        if not isinstance(message, dict):
            return refuse("the request is not a JSON object")
        kind, number, job = message.get("type"), message.get("id"), message.get("job")
        if kind == "stop_sweep":
            return self.sweeps.stop()
        if type(number) is not int or not 0 <= number < 2**53:
            return refuse("the request needs an \"id\", an integer from 0 to 2^53 - 1")
        if not isinstance(job, str) or not job:
            return refuse("the request needs a \"job\", a text in the format of job files", number)
        if kind == "compute":
            return await self.desk.compute(client, number, job)
        if kind != "sweep":
            return refuse("the \"type\" of a request must be \"compute\", \"sweep\" or \"stop_sweep\"", number)
        if job not in client.accepted:
            return refuse("a sweep starts from a job that this page has computed", number)
        try:
            self.sweeps.start(job, message.get("key"), message.get("values"), message.get("more", {}),
                              lambda state: outbox.put({"type": "sweep", "id": number, **state}))
        except NotASweep as error:
            refuse(str(error), number)
