# SPDX-License-Identifier: BSD-3-Clause
"""The server of `shearwake explore` refuses strangers, survives hostile requests, and runs sweeps."""
import asyncio
import contextlib
import fcntl
import http.client
import json
import math
import os
import signal
import socket
import termios
import time
from pathlib import Path

import pytest

import aiohttp

from exploring import Page
from study import InFolder, program
from serving import extent, one

LARGE = one(extent(600.0, 600.0))


def resident_kB(pid):
    with open(f"/proc/{pid}/status", encoding="utf-8") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS:"))


def is_running(pid):
    try:
        return bool(Path(f"/proc/{pid}/cmdline").read_bytes())  # empty if the process waits for its parent
    except OSError:
        return False


class Explore(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.page = cls.enterClassContext(Page(cls.folder))

    def in_session(self, work):
        async def run():
            async with aiohttp.ClientSession(timeout=aiohttp.ClientTimeout(total=program.PATIENCE_s)) as session:
                return await work(session)
        return asyncio.run(run())

    def connected(self, work):
        """Runs `work(socket)` with a connection that the page itself could have opened."""
        async def connect(session):
            async with self.connection(session) as ws:
                return await work(ws)
        return self.in_session(connect)

    def connection(self, session, **options):
        return session.ws_connect(f"{self.page.origin}/socket?token={self.page.token}", max_msg_size=1 << 28,
                                  **{"origin": self.page.origin, **options})

    async def answer(self, ws, number=None):
        """The next answer to this request; of a result, the bytes as well."""
        while True:
            message = json.loads(await ws.receive_str())
            content = await ws.receive_bytes() if message["type"] == "result" else b""
            if number is None or message.get("id") == number:
                return message, content

    async def computed(self, ws, number, job):
        """The type of the answer to a job."""
        await ws.send_str(json.dumps({"type": "compute", "id": number, "job": job}))
        return (await self.answer(ws, number))[0]["type"]

    async def swept(self, ws, number, job, key="load.peak_Pa", values=(50, 100)):
        """The last answer to a sweep, and those while it ran."""
        await ws.send_str(json.dumps({"type": "sweep", "id": number, "job": job, "key": key, "values": list(values)}))
        before = []
        while (message := (await self.answer(ws, number))[0]).get("state") == "running":
            before.append(message)
        return message, before

    def status(self, path, **headers):
        async def get(session):
            async with session.get(f"{self.page.origin}{path}", headers=headers) as response:
                return response.status, dict(response.headers), await response.text()
        return self.in_session(get)

    def status_of_raw(self, path):
        """The status of a path that aiohttp's client would normalise or refuse to send."""
        connection = http.client.HTTPConnection(self.page.host, timeout=program.PATIENCE_s)
        try:
            connection.putrequest("GET", path)
            connection.endheaders()
            return connection.getresponse().status
        finally:
            connection.close()

    def test_the_page_needs_the_token_and_loads_nothing_from_elsewhere(self):
        self.assertEqual(self.status("/")[0], 403)
        self.assertEqual(self.status("/?token=" + "x" * 32)[0], 403)
        self.assertEqual(self.status("/?token=%C3%A9")[0], 403)
        code, headers, text = self.status(f"/?token={self.page.token}")
        self.assertEqual(code, 200)
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertIn("HttpOnly", headers["Set-Cookie"])
        self.assertIn("SameSite=Strict", headers["Set-Cookie"])
        self.assertNotIn("https://", text.replace("https://github.com/leeoniya/uPlot", ""))
        self.assertEqual(self.status(f"/?token={self.page.token}", Host="evil.example")[0], 403)
        for path in ("/etc/passwd", "/page/main.js", "/page.html", "/../explore.py", "/%2e%2e/explore.py"):
            self.assertIn(self.status_of_raw(f"{path}?token={self.page.token}"), (400, 403, 404), path)

    @pytest.mark.extended
    def test_a_forwarded_port_is_accepted_if_it_is_named(self):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        with Page(self.folder, "--port", str(port), "--public-port", "8765") as page:
            self.assertEqual(page.host, "127.0.0.1:8765")
            for host, expected in (("localhost:8765", 200), ("[::1]:8765", 200), (f"127.0.0.1:{port}", 200), ("localhost:8766", 403),
                                   ("evil.example:8765", 403)):
                connection = http.client.HTTPConnection("127.0.0.1", port, timeout=program.PATIENCE_s)
                connection.request("GET", f"/?token={page.token}", headers={"Host": host})
                self.assertEqual(connection.getresponse().status, expected, host)
                connection.close()

    @pytest.mark.extended
    def test_only_this_machine_is_served(self):
        port = int(self.page.host.rsplit(":", 1)[1])
        with socket.socket() as other:  # another address of this machine is free
            other.bind(("127.0.0.2", port))

    def test_other_origins_and_wrong_tokens_cannot_connect(self):
        async def refused(session):
            for options in ({"origin": "http://evil.example"}, {"origin": None}, {"origin": "null"},
                            {"headers": {"Host": "evil.example"}}):
                with self.assertRaises(aiohttp.WSServerHandshakeError, msg=options) as caught:
                    await self.connection(session, **options)
                self.assertEqual(caught.exception.status, 403)
            with self.assertRaises(aiohttp.WSServerHandshakeError):
                await session.ws_connect(f"{self.page.origin}/socket?token=wrong", origin=self.page.origin)
        self.in_session(refused)

    def test_hostile_messages_have_clear_errors(self):
        async def talk(ws):
            for text, expected in (("{", "valid JSON"), ("[" * 100_000, "valid JSON"), ("[]", "JSON object"), ("NaN", "JSON object"),
                                   ('{"type": "compute"}', '"id"'), ('{"type": "compute", "id": true}', '"id"'),
                                   ('{"type": "compute", "id": 1, "job": 5}', '"job"'),
                                   ('{"type": "read", "id": 1, "job": "a"}', '"type"'),
                                   ('{"type": "sweep", "id": 1, "job": "a", "key": "load.peak_Pa", "values": [1, 2]}', "this page has computed")):
                await ws.send_str(text)
                message, _ = await self.answer(ws)
                self.assertEqual((message["type"], message["code"]), ("error", "bad_request"), text[:50])
                self.assertIn(expected, message["message"], text[:50])
            await ws.send_bytes(b"\0" * 100)
            self.assertIn("must be a text", (await self.answer(ws))[0]["message"])
            for job, expected in ((one(extent(1e9, 48.0)), "domain.extent_mm"), (one(extent(9000.0, 9000.0)), "at most"), (one(peak=math.nan), "load.peak_Pa"),
                                  (one({"afferents": {"where": "csv", "file": "/etc/passwd"}}), "file")):
                await ws.send_str(json.dumps({"type": "compute", "id": 7, "job": job}))
                message, _ = await self.answer(ws, 7)
                self.assertEqual(message["type"], "error")
                self.assertIn(expected, message["message"])
        self.connected(talk)

    @pytest.mark.extended
    def test_a_message_that_is_too_long_closes_the_connection_only(self):
        async def talk(ws):
            # The server may close the connection while the message is still being sent, which the sender sees as a reset.
            with contextlib.suppress(ConnectionError, aiohttp.ClientConnectionError):
                await ws.send_str("x" * 2_000_000)
            self.assertIn((await ws.receive()).type, (aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED, aiohttp.WSMsgType.ERROR))
        self.connected(talk)
        self.assertEqual(self.status(f"/?token={self.page.token}")[0], 200)

    @pytest.mark.extended
    def test_a_closed_tab_cancels_its_request_and_others_are_served(self):
        async def talk(session):
            first = await self.connection(session)
            await first.send_str(json.dumps({"type": "compute", "id": 1, "job": LARGE}))
            await asyncio.sleep(0.1)
            await first.close()
            async with self.connection(session) as second:
                await second.send_str(json.dumps({"type": "compute", "id": 2, "job": one()}))
                message, content = await self.answer(second, 2)
                self.assertEqual((message["type"], message["bytes"]), ("result", len(content)))
        self.in_session(talk)

    @pytest.mark.extended
    def test_a_thousand_rapid_changes_do_not_let_the_memory_grow(self):
        async def changes(ws, first):
            async def send():
                for n in range(first, first + 1000):
                    await ws.send_str(json.dumps({"type": "compute", "id": n, "job": one(peak=50.0 + 0.001 * n)}))
            sender = asyncio.create_task(send())
            message, _ = await self.answer(ws, first + 999)
            await sender
            self.assertEqual(message["type"], "result")

        async def talk(ws):
            await changes(ws, 0)
            pids = [pid for pid, command in self.page.children().items() if "shearwake.explore" in command]
            self.assertEqual(len(pids), 1)
            before = resident_kB(pids[0])
            await changes(ws, 1000)
            # Each result has 250 kB: results that are not released would be more than 200 MB.
            self.assertLess(resident_kB(pids[0]) - before, 20000)
        self.connected(talk)

    @pytest.mark.long
    def test_closed_tabs_leave_no_memory_behind(self):
        async def tabs(session, first):
            for n in range(first, first + 40):
                tab = await self.connection(session)
                await tab.send_str(json.dumps({"type": "compute", "id": n, "job": one(peak=50.0 + 0.001 * n)}))
                if n % 2:
                    await self.answer(tab, n)
                    await tab.send_str(json.dumps({"type": "compute", "id": n + 1, "job": LARGE}))
                await tab.close()

        async def talk(session):
            await tabs(session, 0)
            processes = [pid for pid, command in self.page.children().items()
                         if "shearwake.explore" in command or " serve" in command]
            self.assertEqual(len(processes), 2)
            # Tabs that stay in memory with a result of 250 kB each would be 10 MB in each round, with a large one 200 MB. What the
            # engine keeps for the next large computation, up to 100 MB, does not grow further once it has been used.
            for first in range(1000, 7000, 1000):
                before = [resident_kB(pid) for pid in processes]
                await tabs(session, first)
                grown = [resident_kB(pid) - kB for pid, kB in zip(processes, before)]
                if max(grown) < 8000:
                    break
            self.assertLess(max(grown), 8000)
        self.in_session(talk)

    def test_a_sweep_runs_in_a_folder_of_its_own(self):
        async def talk(ws):
            job = one({"measure.at_ms": 4.0})
            self.assertEqual(await self.computed(ws, 1, job), "result")
            for key, values in (("load.peak_Pa", [1]), ("load.peak_Pa", ["a", 2]), ("../x", [1, 2]), ("load.peak_Pa", [1, float("inf")]),
                                ("load.peak_Pa", [10 ** 400, 1])):
                self.assertEqual((await self.swept(ws, 2, job, key, values))[0]["type"], "error")
            return (await self.swept(ws, 3, job))[0]
        message = self.connected(talk)
        self.assertEqual(message["state"], "done", message)
        self.assertEqual(message["columns"][0], "load.peak_Pa")
        peak = message["columns"].index("peak_um")
        (first, second) = message["rows"]
        self.assertAlmostEqual(second[peak] / first[peak], 2.0, places=6)  # tables have nine digits
        self.assertTrue((Path(message["folder"]) / "plan.json").is_file())

    @pytest.mark.extended
    def test_a_sweep_uses_a_new_folder(self):
        async def talk(ws):
            self.assertEqual(await self.computed(ws, 1, one()), "result")
            for later_s in range(120):  # as if sweeps had been started in each of these seconds
                name = time.strftime("explore-%Y%m%d-%H%M%S", time.localtime(time.time() + later_s))
                (Path(self.folder) / name).mkdir(exist_ok=True)
            return (await self.swept(ws, 2, one()))[0]
        message = self.connected(talk)
        self.assertEqual(message["state"], "done", message)
        self.assertRegex(message["folder"], r"explore-\d{8}-\d{6}-\d+$")

    @pytest.mark.extended
    def test_a_sweep_ignores_tables_that_add_cases(self):
        async def talk(ws):
            swept = 0
            for number, change in ((1, {"table": 5}), (3, {"uncertain": {"samples": 4096, "load.peak_Pa": {"uniform": [50, 100]}}})):
                job = one(change)
                if await self.computed(ws, number, job) != "result":
                    continue
                message, before = await self.swept(ws, number + 1, job)
                self.assertLessEqual({other["total"] for other in before}, {2})
                self.assertEqual(message.get("state"), "done", message)
                self.assertEqual(len(message["rows"]), 2)
                swept += 1
            self.assertEqual(swept, 2)
        self.connected(talk)

    def test_the_engine_is_started_again_if_it_ends(self):
        async def talk(ws):
            engines = [pid for pid, command in self.page.children().items() if command.endswith(" serve")]
            self.assertEqual(len(engines), 1)
            os.kill(engines[0], signal.SIGSTOP)
            await ws.send_str(json.dumps({"type": "compute", "id": 1, "job": LARGE}))
            with open(f"/proc/{engines[0]}/fd/0", "rb") as requests:
                while fcntl.ioctl(requests, termios.FIONREAD, bytes(4)) == bytes(4):  # it has not been sent to the engine
                    await asyncio.sleep(0.01)
            os.kill(engines[0], signal.SIGKILL)
            message, _ = await self.answer(ws, 1)
            self.assertEqual((message["type"], message["code"]), ("error", "ended"))
            self.assertEqual(await self.computed(ws, 2, one()), "result")
        self.connected(talk)

    @pytest.mark.extended
    def test_the_server_ends_with_the_command(self):
        with Page(self.folder) as page:
            children = [process for process in page.children() if process != page.process.pid]
            self.assertTrue(children)
            os.kill(page.process.pid, signal.SIGTERM)
            page.process.wait(program.PATIENCE_s)
            end = time.monotonic() + program.PATIENCE_s
            while left := [process for process in children if is_running(process)]:
                self.assertLess(time.monotonic(), end, f"still running: {left}")
                time.sleep(0.05)
