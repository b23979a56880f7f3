"""HTTP proxies of the environment, as gRPC takes them: grpc_proxy, https_proxy, http_proxy, and no_grpc_proxy,
no_proxy."""

import os
import re


def is_loopback(address: str) -> bool:
    """Whether `address` (HOST:PORT, or gRPC's ipv4:, ipv6:, dns: and unix: forms) is this machine itself."""
    host = _host_of(address)
    if address.startswith(("unix:", "unix-abstract:")) or host in ("localhost", "::1", "0.0.0.0", "::"):
        return True
    return re.fullmatch(r"127\.\d+\.\d+\.\d+", host) is not None  # 127.example.com is somewhere else


def proxy_in_use(address: str) -> str:
    """ "http://proxy:3128 of https_proxy" where calls go through a proxy, else "". A user and password are left out."""
    excluded = os.environ.get("no_grpc_proxy") or os.environ.get("no_proxy") or ""
    entries = [entry.strip() for entry in excluded.split(",")]
    if is_loopback(address) or any(entry and _host_of(address).endswith(entry) for entry in entries):
        return ""
    for name in ("grpc_proxy", "https_proxy", "http_proxy"):
        if os.environ.get(name):
            return re.sub(r"(://)?[^/@]*@", r"\1", os.environ[name], count=1) + f" of {name}"
    return ""


def _host_of(address: str) -> str:
    address = re.sub(r"^(dns|ipv4|ipv6):(.*/)?", "", address)
    if address.startswith("["):
        return address[1:].partition("]")[0]
    return address.partition(":")[0] if address.count(":") == 1 else address  # else a bare IPv6 address
