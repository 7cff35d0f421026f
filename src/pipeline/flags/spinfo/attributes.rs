//! What `spinfo` prints about attributes of points.

use serde_json::{Value, json};

use spmesh_shell::messages::escaped;
use spmesh_stream::model::attributes::Attribute;

/// An attribute in words.
pub(super) fn text(attribute: &Attribute) -> String {
    let Attribute { name, number, components, unit, scale, unknown, .. } = attribute;
    let mut text = escaped(name);
    text += &match components {
        1 => format!(", {}", number.name()),
        _ => format!(", {components} {}", number.name()),
    };
    if let Some([scale, offset]) = scale {
        text += &format!(" * {scale} + {offset}");
    }
    if !unit.is_empty() {
        text += &format!(", {}", escaped(unit));
    }
    if let Some(unknown) = unknown {
        text += &format!(", {} if unknown", number.read(unknown));
    }
    text
}

/// An attribute as JSON.
pub(super) fn json(attribute: &Attribute) -> Value {
    let Attribute { name, number, components, unit, las_name, scale, unknown } = attribute;
    json!({
        "name": name,
        "type": number.name(),
        "components": components,
        "unit": unit,
        "las_name": las_name,
        "scale": scale.map(|[scale, _]| scale),
        "offset": scale.map(|[_, offset]| offset),
        "unknown": unknown.as_ref().map(|bytes| number.read(bytes).to_string()),
    })
}
