// SPDX-License-Identifier: MIT
// Plays a stroke through `tactor serve --tcp 4001` from C#, with nothing but the system's own classes, and waits for its end.
//   mcs -r:System.Runtime.Serialization -r:System.Xml.Linq serve_client.cs
//   mono serve_client.exe [STROKE [HOST PORT [TOKEN]]]     default: park2016-1 127.0.0.1 4001
using System;
using System.IO;
using System.Net.Sockets;
using System.Runtime.Serialization.Json;
using System.Text;
using System.Xml;
using System.Xml.Linq;

static class ServeClient {
    static StreamReader from;
    static StreamWriter to;
    static int calls;

    // Reads the next line: a reply, or a notification, which has a method.
    static XElement Receive() {
        string line = from.ReadLine();
        if (line == null) throw new IOException("the service closed the connection");
        return XElement.Load(JsonReaderWriterFactory.CreateJsonReader(Encoding.UTF8.GetBytes(line), XmlDictionaryReaderQuotas.Max));
    }

    // Returns the result of a method of tactor-protocol(7). Throws what the service refuses.
    static XElement Call(string method, string parameters) {
        to.WriteLine("{\"jsonrpc\":\"2.0\",\"id\":" + ++calls + ",\"method\":\"" + method + "\",\"params\":{" + parameters + "}}");
        XElement m;
        do m = Receive(); while (m.Element("method") != null);
        if (m.Element("error") != null) throw new IOException(m.Element("error").Element("message").Value);
        return m.Element("result");
    }

    static string Text(string key, string s) { return '"' + key + "\":\"" + s.Replace("\\", "\\\\").Replace("\"", "\\\"") + '"'; }

    static int Main(string[] args) {
        Func<int, string, string> arg = (i, otherwise) => i < args.Length ? args[i] : otherwise;
        try {
            var stream = new TcpClient(arg(1, "127.0.0.1"), int.Parse(arg(2, "4001"))).GetStream();
            from = new StreamReader(stream);
            to = new StreamWriter(stream) { AutoFlush = true, NewLine = "\n" };
            Call("hello", args.Length > 3 ? Text("token", args[3]) : "");
            string stroke = Call("play", Text("stroke", arg(0, "park2016-1"))).Element("stroke").Value, state = "started";
            while (state == "started") {
                XElement p = Receive().Element("params");
                if (p?.Element("stroke")?.Value == stroke) state = p.Element("state").Value;
            }
            Console.WriteLine(arg(0, "park2016-1") + ": " + state);
            return state == "finished" ? 0 : 1;
        } catch (Exception e) {
            Console.Error.WriteLine("serve_client: " + e.Message);
            return 1;
        }
    }
}
