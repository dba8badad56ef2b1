# SPDX-License-Identifier: BSD-3-Clause
"""Serves the page of `shearwake explore` on 127.0.0.1 until it is interrupted.

Usage: python3 -m shearwake.explore --program PATH [--port N] [--public-port N] [--ranks N] [--out DIR] [--no-browser]
"""
import argparse
import asyncio
import contextlib
import os
import secrets
import signal
import sys
import webbrowser

from aiohttp import web

from .. import program
from ..engine import Engine
from ..errors import ShearwakeError
from .page import first_job, keys_of
from .server import Explorer


async def serve(arguments: argparse.Namespace) -> None:
    token = secrets.token_urlsafe(24)
    explorer = Explorer(Engine(arguments.ranks), token, arguments.out, keys_of(), arguments.public_port)
    runner = web.AppRunner(explorer.application(), access_log=None)
    await runner.setup()
    try:
        stop = asyncio.Event()
        for number in (signal.SIGINT, signal.SIGTERM):
            asyncio.get_running_loop().add_signal_handler(number, stop.set)
        print("Computing the first picture ...", file=sys.stderr, flush=True)
        preparing, stopping = asyncio.create_task(explorer.desk.prepare(first_job())), asyncio.create_task(stop.wait())
        await asyncio.wait({preparing, stopping}, return_when=asyncio.FIRST_COMPLETED)
        if stop.is_set():
            return
        site = web.TCPSite(runner, "127.0.0.1", arguments.port, shutdown_timeout=2)
        await site.start()
        explorer.port = runner.addresses[0][1]
        address = f"http://127.0.0.1:{explorer.public_port or explorer.port}/?token={token}"
        print(f"{address}\nThis page is reachable from this machine only. Ctrl-C ends it.", flush=True)
        if arguments.browser:
            await asyncio.to_thread(webbrowser.open, address)
        await stopping
    finally:
        await runner.cleanup()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--port", type=int, default=0)
    parser.add_argument("--public-port", type=int, default=0)
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--out", default="out")
    parser.add_argument("--no-browser", dest="browser", action="store_false")
    arguments = parser.parse_args()
    environment = program.environment()
    os.environ.clear()
    os.environ.update(environment, SHEARWAKE=arguments.program)
    try:
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(serve(arguments))
    except (OSError, ShearwakeError) as error:
        sys.exit(f"the page cannot be served: {error}")


if __name__ == "__main__":
    main()
