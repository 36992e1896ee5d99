"""The package of the extension for Visual Studio Code, a zip archive that the editor installs."""

from __future__ import annotations

import json
from collections.abc import Iterable
from mimetypes import guess_type
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

_FOLDER = Path(__file__).with_name("vscode")
_MANIFEST = """\
<?xml version="1.0" encoding="utf-8"?>
<PackageManifest Version="2.0.0" xmlns="http://schemas.microsoft.com/developer/vsx-schema/2011">
  <Metadata>
    <Identity Language="en-US" Id="{name}" Version="{version}" Publisher="{publisher}"/>
    <DisplayName>{displayName}</DisplayName>
    <Description>{description}</Description>
    <Properties>
      <Property Id="Microsoft.VisualStudio.Code.Engine" Value="{engines[vscode]}"/>
    </Properties>
  </Metadata>
  <Installation><InstallationTarget Id="Microsoft.VisualStudio.Code"/></Installation>
  <Dependencies/>
  <Assets>
    <Asset Type="Microsoft.VisualStudio.Code.Manifest" Path="extension/package.json" Addressable="true"/>
  </Assets>
</PackageManifest>
"""


def write_vscode_package(file: Path, version: str, command: str) -> None:
    """Write the extension; `command`: where `lrp` is on this computer."""
    about = json.loads((_FOLDER / "package.json").read_text("utf-8"))
    about["version"] = version
    about["contributes"]["configuration"]["properties"]["lrp.command"]["default"] = [command]
    entries = {
        "extension.vsixmanifest": _MANIFEST.format_map(about),
        "extension/package.json": json.dumps(about, indent=2),
    }
    for each in sorted(filter(Path.is_file, _FOLDER.iterdir())):
        entries.setdefault(f"extension/{each.name}", each.read_text("utf-8"))
    entries["[Content_Types].xml"] = _content_types(entries)
    with ZipFile(file, "w", ZIP_DEFLATED) as archive:
        for name, text in entries.items():
            archive.writestr(ZipInfo(name), text, ZIP_DEFLATED)


def _content_types(names: Iterable[str]) -> str:
    """Return the list of the types of files that the format of the archive demands."""
    listed = "".join(
        f'<Default Extension="{end}" ContentType="{guess_type(f"a{end}")[0] or "application/octet-stream"}"/>'
        for end in sorted({Path(name).suffix for name in names})
    )
    namespace = "http://schemas.openxmlformats.org/package/2006/content-types"
    return f'<?xml version="1.0" encoding="utf-8"?>\n<Types xmlns="{namespace}">{listed}</Types>\n'
