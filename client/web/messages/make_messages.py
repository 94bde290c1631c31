#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Generates the messages of a .proto file as C++ classes without libprotobuf.

    make_messages.py FILE.proto HEADER

The header has the accessors that protoc would generate, as far as hapticast uses them. So the code that reads and
writes messages compiles with either header. wire_message.hpp reads and writes the bytes. The script knows the part of
proto3 that hapticast.proto uses: messages, enums, one oneof, optional and repeated fields. It ends with an error at
anything else."""
import re
import sys

# Type of C++, and type of the member that stores a field.
NUMBERS = {
    "uint32": ("std::uint32_t", "Varint"), "uint64": ("std::uint64_t", "Varint"),
    "int32": ("std::int32_t", "Varint"), "int64": ("std::int64_t", "Varint"), "bool": ("bool", "Varint"),
    "fixed32": ("std::uint32_t", "Fixed"), "fixed64": ("std::uint64_t", "Fixed"),
    "sfixed64": ("std::int64_t", "Fixed"), "double": ("double", "Fixed"), "float": ("float", "Fixed"),
}
TEXTS = {"string": "Text", "bytes": "Bytes"}


class Field:
    def __init__(self, label, kind, name, number, in_oneof):
        self.label, self.kind, self.name, self.number = label, kind, name.lower(), int(number)
        self.in_oneof = in_oneof

    def constant(self):
        return "k" + "".join(part.capitalize() for part in self.name.split("_"))


def parse(text):
    """Returns the enums and the messages of a .proto file, in its order."""
    text = re.sub(r"//[^\n]*", "", text)
    enums = {name: re.findall(r"(\w+) = (\d+)", body) for name, body in re.findall(r"enum (\w+) \{([^}]*)\}", text)}
    messages = {}
    for name, body in re.findall(r"message (\w+) \{((?:[^{}]|\{[^{}]*\})*)\}", text):
        oneof = re.search(r"oneof content \{([^}]*)\}", body)
        fields = []
        for part in re.split(r"[;{}]", body):
            part = part.strip()
            if not part or part == "oneof content" or part.startswith("reserved "):
                continue
            found = re.fullmatch(r"(?:(optional|repeated) )?(\w+) (\w+) = (\d+)", part)
            if not found:
                sys.exit(f"message {name}: cannot read {part!r}")
            fields.append(Field(*found.groups(), oneof is not None and part + ";" in oneof[1]))
        messages[name] = sorted(fields, key=lambda field: field.number)
    return enums, messages


def order(messages):
    """Returns the names of the messages, so that each follows those that it contains."""
    ordered = []

    def visit(name):
        for field in messages[name]:
            if field.kind in messages and field.kind not in ordered:
                visit(field.kind)
        if name not in ordered:
            ordered.append(name)

    for name in messages:
        visit(name)
    return ordered


def write_repeated(field, messages):
    name = field.name
    if field.kind in messages:
        member = f"wire::Messages<{field.kind}>"
        extra = f"  {field.kind}* add_{name}() {{ return &{name}_.emplace_back(); }}\n"
    elif field.kind == "float":
        member = "wire::Floats"
        extra = f"  wire::Floats* mutable_{name}() {{ return &{name}_; }}\n"
    elif field.kind == "bytes":
        member = "wire::Strings"
        extra = (f"  void add_{name}(const void* data, std::size_t size) {{\n"
                 f"    {name}_.emplace_back(static_cast<const char*>(data), size);\n  }}\n")
    else:
        sys.exit(f"repeated {field.kind} {name}: not supported")
    return member, (f"  const {member}& {name}() const {{ return {name}_; }}\n"
                    f"  int {name}_size() const {{ return static_cast<int>({name}_.size()); }}\n{extra}")


def write_message_field(field):
    name, kind = field.name, field.kind
    begin = f"begin({field.constant()}); " if field.in_oneof else ""
    return f"wire::Boxed<{kind}>", (
        f"  bool has_{name}() const {{ return {name}_.has(); }}\n"
        f"  const {kind}& {name}() const {{ return {name}_.get(); }}\n"
        f"  {kind}* mutable_{name}() {{ {begin}return &{name}_.make(); }}\n")


def write_text_field(field):
    name = field.name
    return f"wire::{TEXTS[field.kind]}", (
        f"  const std::string& {name}() const {{ return {name}_.value; }}\n"
        f"  void set_{name}(std::string value) {{ {name}_.value = std::move(value); }}\n"
        f"  void set_{name}(const void* data, std::size_t size) {{\n"
        f"    {name}_.value.assign(static_cast<const char*>(data), size);\n  }}\n")


def write_number_field(field, enums):
    name = field.name
    kind, coding = (field.kind, "Varint") if field.kind in enums else NUMBERS[field.kind]
    if field.label == "optional":
        return f"wire::Optional<wire::{coding}<{kind}>>", (
            f"  bool has_{name}() const {{ return {name}_.given; }}\n"
            f"  {kind} {name}() const {{ return {name}_.number.value; }}\n"
            f"  void set_{name}({kind} value) {{ {name}_ = {{{{value}}, true}}; }}\n")
    return f"wire::{coding}<{kind}>", (
        f"  {kind} {name}() const {{ return {name}_.value; }}\n"
        f"  void set_{name}({kind} value) {{ {name}_.value = value; }}\n")


def write_field(field, enums, messages):
    """Returns the type of the member for a field, and its accessors."""
    if field.label == "repeated":
        return write_repeated(field, messages)
    if field.kind in messages:
        return write_message_field(field)
    if field.kind in TEXTS and field.label is None:
        return write_text_field(field)
    if field.kind not in NUMBERS and field.kind not in enums:
        sys.exit(f"{field.kind} {field.name}: not supported")
    return write_number_field(field, enums)


def write_oneof(fields):
    cases = "".join(f", {field.constant()} = {field.number}" for field in fields)
    numbers = " || ".join(f"number == {field.number}" for field in fields)
    resets = " ".join(f"{field.name}_.reset();" for field in fields)
    return (f"  enum ContentCase {{ CONTENT_NOT_SET = 0{cases} }};\n"
            "  ContentCase content_case() const { return content_; }\n"
            "  /// Makes the field `number` the content, if it belongs to the oneof. Removes another content.\n"
            "  void begin(unsigned number) {\n"
            f"    if (number == content_ || !({numbers})) return;\n"
            f"    {resets}\n    content_ = static_cast<ContentCase>(number);\n  }}\n")


def write_message(name, fields, enums, messages):
    oneof = [field for field in fields if field.in_oneof]
    members, accessors = [], write_oneof(oneof) if oneof else ""
    for field in fields:
        member, functions = write_field(field, enums, messages)
        members.append(f"  {member} {field.name}_;\n")
        accessors += f"  static constexpr int {field.constant()}FieldNumber = {field.number};\n" + functions
    if oneof:
        members.append("  ContentCase content_ = CONTENT_NOT_SET;\n")
    visits = " ".join(f"visit({field.number}U, self.{field.name}_);" for field in fields)
    return (f"class {name} : public wire::Message<{name}> {{\n public:\n{accessors}"
            "  template <class Self, class Visit>\n"
            f"  static void visitFields(Self& self, Visit&& visit) {{\n    {visits}\n  }}\n\n private:\n"
            f"{''.join(members)}}};\n")


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        enums, messages = parse(file.read())
    out = ['// Generated by make_messages.py.\n#pragma once\n#include "client/web/messages/wire_message.hpp"\n',
           "namespace hapticast::proto {\n"]
    for name, values in enums.items():
        if [int(number) for _, number in values] != list(range(len(values))):
            sys.exit(f"enum {name}: its numbers are not 0, 1, 2 ...")
        out.append(f"enum {name} : int {{ {', '.join(f'{value} = {number}' for value, number in values)} }};\n"
                   f"inline bool {name}_IsValid(int value) {{ return value >= 0 && value < {len(values)}; }}\n")
    out += [write_message(name, messages[name], enums, messages) for name in order(messages)]
    out.append("}  // namespace hapticast::proto\n")
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write("".join(out))


main()
