# SPDX-License-Identifier: MIT
"""tactor serve with other people's clients: curl, one of JSON-RPC, and one of WebSockets, each from Debian."""
import json
import pathlib
import shutil
import subprocess
import unittest

from harness import PATIENCE_S, ToolTest, main
from serving import Server

# Debian's python, for which its modules are.
PYTHON = "/usr/bin/python3"

JSON_RPC = """
import asyncio, json, sys
import aiorpcx

class Listener(aiorpcx.RPCSession):
    async def handle_request(self, request):
        heard.append([request.method, request.args])
        if request.args.get("state") == "finished":
            ended.set()

async def refused(session, method, params):
    try:
        await session.send_request(method, params)
    except aiorpcx.RPCError as e:
        return e.code

async def talk(host, port):
    global heard, ended
    heard, ended = [], asyncio.Event()
    make = lambda transport: Listener(transport, connection=aiorpcx.JSONRPCConnection(aiorpcx.JSONRPCv2))
    async with aiorpcx.connect_rs(host, int(port), session_factory=make, framer=aiorpcx.NewlineFramer()) as session:
        said = {"hello": await session.send_request("hello", {})}
        said["unknown"] = await refused(session, "nonsense", {})
        said["bad"] = await refused(session, "play", {"stroke": "park2016-9"})
        async with session.send_batch() as batch:
            for method in ("status", "hello", "status"):
                batch.add_request(method, {})
        said["batch"] = len(batch.results)
        said["play"] = await session.send_request("play", {"path": "M 0 0 L 40 0", "options": {"duration": 0.1}})
        await asyncio.wait_for(ended.wait(), float(sys.argv[2]))
        said["heard"] = heard
    print(json.dumps(said))

asyncio.run(talk(*sys.argv[1].rsplit(":", 1)))
"""

WEBSOCKET = """
import asyncio, json, sys
import websockets

async def talk(url):
    async with websockets.connect(url) as socket:
        await socket.send('{"jsonrpc":"2.0","id":1,"method":"hello","params":{}}')
        said = [json.loads(await socket.recv())]
        await (await socket.ping())
        await socket.send(['{"jsonrpc":"2.0",', '"id":2,"method":"status"}'])  # one message in two frames
        said.append(json.loads(await socket.recv()))
    print(json.dumps([said, socket.close_code]))

asyncio.run(talk(sys.argv[1]))
"""


def need(module):
    if not pathlib.Path(PYTHON).exists() or subprocess.run([PYTHON, "-c", f"import {module}"], capture_output=True, check=False).returncode != 0:
        raise unittest.SkipTest(f"Debian's python3-{module} is not here")


class Others(ToolTest):
    def program(self, *args):
        r = subprocess.run([*map(str, args)], cwd=self.dir, capture_output=True, text=True, timeout=PATIENCE_S, check=False)
        self.assertEqual((r.returncode, r.stderr), (0, ""))
        return r.stdout

    def test_a_client_of_json_rpc_works(self):
        need("aiorpcx")
        s = Server(self, "--tcp", "0")
        said = json.loads(self.program(PYTHON, "-c", JSON_RPC, s.where["tcp"], PATIENCE_S))
        self.assertEqual(said["hello"]["protocol"], "tactor/1")
        self.assertEqual((said["unknown"], said["bad"], said["batch"]), (-32601, -32602, 3))
        number = said["play"]["stroke"]
        states = [told["state"] for method, told in said["heard"] if method == "stroke" and told["stroke"] == number]
        self.assertEqual(states, ["started", "finished"])

    def test_a_client_of_websockets_works(self):
        need("websockets")
        s = Server(self, "--http", "0")
        (hello, status), code = json.loads(self.program(PYTHON, "-c", WEBSOCKET, s.where["http"].replace("http", "ws", 1) + "rpc"))
        self.assertEqual((hello["id"], hello["result"]["protocol"]), (1, "tactor/1"))
        self.assertEqual((status["id"], status["result"]["clients"]), (2, 1))
        self.assertEqual(code, 1000)

    @unittest.skipUnless(shutil.which("curl"), "curl is not here")
    def test_curl_works(self):
        s = Server(self, "--http", "0")
        http = s.where["http"]
        curl = lambda *args: self.program("curl", "--silent", "--show-error", "--noproxy", "*", *args)
        self.assertEqual(json.loads(curl(http + "status"))["stream"]["state"], "running")
        head = curl("--output", "page.html", "--write-out", "%{http_code} %{content_type}", http)
        self.assertEqual(head, "200 text/html; charset=utf-8")
        self.assertIn("<title>", (self.dir / "page.html").read_text())
        code = ("--output", "nothing", "--write-out", "%{http_code}")
        self.assertEqual(curl(*code, "--header", "Origin: http://evil.example", http + "status"), "403")
        self.assertEqual(curl(*code, "--header", "Host: evil.example", http + "status"), "403")
        self.assertEqual(curl(*code, "--data", '{"jsonrpc":"2.0","id":1,"method":"stop"}', http + "rpc"), "405")


if __name__ == "__main__":
    main()
