//! Tests of the first lines, for formats of molecules that are named in messages only.

/// The first lines.
fn lines(head: &[u8]) -> impl Iterator<Item = &str> {
    const SEEN: usize = 1000;
    head.split(|&byte| byte == b'\n').take(SEEN).map_while(|line| std::str::from_utf8(line).ok())
}

/// Whether a line has the columns of an atom of GROMACS: residue, name, serial number and coordinates.
fn is_gro_atom(line: &str) -> bool {
    let number =
        |start: usize, end: usize| line.get(start..end).map(str::trim).filter(|text| !text.is_empty());
    let is_integer = |text: &str| text.parse::<u32>().is_ok();
    let has_name = line.get(5..10).is_some_and(|name| name.contains(|c: char| c.is_ascii_alphabetic()));
    let coordinates = [(20, 28), (28, 36), (36, 44)];
    has_name
        && number(0, 5).is_some_and(is_integer)
        && number(15, 20).is_some_and(is_integer)
        && coordinates
            .iter()
            .all(|&(start, end)| number(start, end).is_some_and(|text| text.parse::<f64>().is_ok()))
}

/// Whether the text is a GRO file: a title, a count, and atoms.
pub(crate) fn is_gro(head: &[u8]) -> bool {
    let mut lines = lines(head).skip(1);
    let has_count = lines.next().is_some_and(|line| line.trim().parse::<u64>().is_ok());
    has_count && lines.next().is_some_and(is_gro_atom)
}

/// Whether the text is a data file of LAMMPS, which states the limits of its box, or a dump.
pub(crate) fn is_lammps(head: &[u8]) -> bool {
    let is_limits = |line: &str| line.split_ascii_whitespace().skip(2).take(2).eq(["xlo", "xhi"]);
    head.starts_with(b"ITEM: TIMESTEP") || lines(head).any(is_limits)
}

/// Whether the text is a MOL2 file.
pub(crate) fn is_mol2(head: &[u8]) -> bool {
    lines(head).any(|line| line.starts_with("@<TRIPOS>"))
}

/// Whether the text is an SDF or MOL file: its fourth line ends with a version.
pub(crate) fn is_sdf(head: &[u8]) -> bool {
    lines(head)
        .nth(3)
        .is_some_and(|line| [" V2000", " V3000"].iter().any(|end| line.trim_end().ends_with(end)))
}
