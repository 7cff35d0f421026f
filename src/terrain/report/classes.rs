//! Names of the classes of LAS points. Source: LAS specification 1.4 R15, tables 9 and 17.

const NAMES: [&str; 23] = [
    "Created, never classified",
    "Unclassified",
    "Ground",
    "Low vegetation",
    "Medium vegetation",
    "High vegetation",
    "Building",
    "Low point (noise)",
    "Reserved",
    "Water",
    "Rail",
    "Road surface",
    "Overlap or reserved",
    "Wire guard (shield)",
    "Wire conductor (phase)",
    "Transmission tower",
    "Wire-structure connector",
    "Bridge deck",
    "High noise",
    "Overhead structure",
    "Ignored ground",
    "Snow",
    "Temporal exclusion",
];

/// The name of a class.
pub fn class_name(class: u8) -> &'static str {
    match class {
        64.. => "User definable",
        _ => NAMES.get(usize::from(class)).copied().unwrap_or("Reserved"),
    }
}
