"""A WebDAV server of a folder on a free port, which it prints; it ends when its input does."""

import sys
import threading

from cheroot.wsgi import Server
from wsgidav.wsgidav_app import WsgiDAVApp

settings = {
    "provider_mapping": {"/": sys.argv[1]},
    "simple_dc": {"user_mapping": {"*": True}},
    "logging": {"enable": False},
    "verbose": 0,
}
server = Server(("127.0.0.1", 0), WsgiDAVApp(settings))
server.prepare()
threading.Thread(target=server.serve, daemon=True).start()
print(server.bind_addr[1], flush=True)
sys.stdin.read()
server.stop()
