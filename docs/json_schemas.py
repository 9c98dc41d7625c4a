"""Writes the JSON schemas of the YAML files, for editors to check and complete them.

python docs/json_schemas.py
"""

import dataclasses
import json
from pathlib import Path
from typing import Any

import source_docs
from pydantic import TypeAdapter
from pydantic.json_schema import GenerateJsonSchema

from atlas_drake.clients.campaigns.campaign import Campaign
from atlas_drake.config import Configuration
from atlas_drake.robot import RobotFile
from atlas_drake.scenario import Scenario
from atlas_drake.shipped import CONTROLLER
from atlas_drake.worlds.world_file import World

FILES: dict[str, type] = {
    "scenario": Scenario,
    "world": World,
    "robot": RobotFile,
    "campaign": Campaign,
}
SCENARIO = "scenario.schema.json"
FOLDER = Path(__file__).parent / "schema"


class _Generator(GenerateJsonSchema):
    def function_plain_schema(self, schema: Any) -> dict[str, Any]:
        """A pose, which has several forms, is a mapping."""
        return {"type": "object"}

    def encode_default(self, dft: Any) -> Any:
        """A default that YAML cannot have is left to the reference page."""
        try:
            return super().encode_default(dft)
        except Exception:
            return None


def schema_of(kind: type) -> dict[str, Any]:
    """The JSON schema of one kind of file."""
    schema = TypeAdapter(kind).json_schema(schema_generator=_Generator)
    known = schema.setdefault("$defs", {})
    if kind is Scenario:
        controller = TypeAdapter(type(CONTROLLER)).json_schema(
            schema_generator=_Generator
        )
        # The fields of a user's own behaviors depend on what is registered.
        controller["additionalProperties"] = {"type": "object"}
        known |= {**controller.pop("$defs"), "ControllerConfig": controller}
    if kind is Campaign:
        _refer_to_scenario(schema)
    classes = {cls.__name__: cls for cls in _subclasses(Configuration)}
    for part in (schema, *known.values()):
        cls = classes.get(part.get("title", ""))
        if cls is not None:
            _describe(part, cls)
    return schema


def _refer_to_scenario(campaign: dict[str, Any]) -> None:
    """Lets a campaign have a scenario, and a scenario's fields beside its own."""
    known = {"Scenario", *schema_of(Scenario)["$defs"]}
    own = campaign["$defs"].items()
    campaign["$defs"] = {name: part for name, part in own if name not in known}
    fields = campaign["properties"]
    fields["scenario"] = {"$ref": SCENARIO}
    for field in dataclasses.fields(Scenario):
        fields.setdefault(field.name, {"$ref": f"{SCENARIO}#/properties/{field.name}"})


def _describe(part: dict[str, Any], cls: type) -> None:
    """Adds the docstrings of a class, and what of its fields pydantic does not know."""
    part["description"] = source_docs.head(cls.__doc__)
    told = source_docs.fields(cls)
    fields = part["properties"]
    if "controller" in fields:
        # Once for all files: editors follow a path to another schema.
        fields["controller"] = {"$ref": f"{SCENARIO}#/$defs/ControllerConfig"}
    for name in {"plant", "simulator"} & fields.keys():
        # Which fields Drake's configurations have depends on its version.
        fields[name] = {"type": "object"}
    for name in {"world", "scenario", "code"} & fields.keys():
        # A name or a path may take the place of the fields, or of a list.
        fields[name] = {"anyOf": [fields[name], {"type": "string"}]}
    for name, field in fields.items():
        field.pop("title", None)
        if name in told:
            field["description"] = told[name]


def _subclasses(cls: type) -> list[type]:
    return [found for sub in cls.__subclasses__() for found in (sub, *_subclasses(sub))]


def schema_files() -> dict[str, str]:
    """The text of every schema by the name of its file."""
    return {
        f"{name}.schema.json": json.dumps(
            schema_of(kind), indent=1, ensure_ascii=False, sort_keys=True
        )
        + "\n"
        for name, kind in FILES.items()
    }


if __name__ == "__main__":
    for name, text in schema_files().items():
        (FOLDER / name).write_text(text, encoding="utf-8")
