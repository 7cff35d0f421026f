//! Structure files to triangulate.

use std::fmt::Write;

/// An atom of a PDB file.
#[derive(Clone)]
pub struct Record {
    pub record: &'static str,
    pub serial: u32,
    pub name: &'static str,
    pub altloc: char,
    pub residue: &'static str,
    pub chain: char,
    pub number: i32,
    pub at: [f64; 3],
    pub occupancy: f64,
    pub element: &'static str,
}

impl Record {
    /// A carbon atom of chain A, each in a residue of its own.
    pub fn carbon(serial: u32, at: [f64; 3]) -> Record {
        Record {
            record: "ATOM",
            serial,
            name: "CA",
            altloc: ' ',
            residue: "ALA",
            chain: 'A',
            number: (serial % 10_000) as i32,
            at,
            occupancy: 1.0,
            element: "C",
        }
    }

    /// The line of the file.
    pub fn line(&self) -> String {
        let Record { record, serial, name, altloc, residue, chain, number, at: [x, y, z], .. } = self;
        let Record { occupancy, element, .. } = self;
        format!(
            "{record:<6}{serial:>5} {:<4}{altloc}{residue:>3} {chain}{number:>4}    {x:>8.3}{y:>8.3}{z:>8.3}\
             {occupancy:>6.2}{:>6.2}          {element:>2}\n",
            format!(" {name}"),
            0.0,
        )
    }
}

/// A PDB file of the atoms.
pub fn pdb(atoms: &[Record]) -> String {
    atoms.iter().map(Record::line).collect::<String>() + "END\n"
}

/// A PDB file with one model per list of atoms, numbered from 1.
pub fn models(models: &[Vec<Record>]) -> String {
    let mut text = String::new();
    for (number, atoms) in (1..).zip(models) {
        writeln!(text, "MODEL     {number:>4}").unwrap();
        atoms.iter().for_each(|atom| text += &atom.line());
        text += "ENDMDL\n";
    }
    text + "END\n"
}

/// A linear congruential generator: numbers from 0 to `bound` - 1.
pub fn numbers(seed: u64, bound: u64) -> impl FnMut() -> u64 {
    let mut state = seed.wrapping_mul(2).wrapping_add(1);
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % bound
    }
}

/// Carbon atoms at random multiples of 0.001 Å in a cube, with serial numbers 10, 20, 30, ...
pub fn cloud(count: u32, side_in_steps: u64, seed: u64) -> Vec<Record> {
    let mut number = numbers(seed, side_in_steps);
    let mut coordinate = || number() as f64 / 1000.0;
    (1..=count).map(|i| Record::carbon(10 * i, [coordinate(), coordinate(), coordinate()])).collect()
}

/// The rows of a table, with access by column name.
pub struct Rows {
    columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Rows {
    pub fn new(text: &str) -> Rows {
        let mut lines = text.lines().map(|line| line.split('\t').map(str::to_string).collect::<Vec<_>>());
        let columns = lines.next().expect("a line of columns");
        let rows: Vec<_> = lines.collect();
        assert!(rows.iter().all(|row| row.len() == columns.len()), "{text}");
        Rows { columns, rows }
    }

    pub fn len(&self) -> usize {
        self.rows.len()
    }

    pub fn text(&self, row: usize, column: &str) -> &str {
        let place = self.columns.iter().position(|name| name == column);
        &self.rows[row][place.unwrap_or_else(|| panic!("no column {column}"))]
    }

    pub fn number(&self, row: usize, column: &str) -> f64 {
        self.text(row, column).parse().unwrap()
    }

    /// Whether there is a column.
    pub fn has(&self, column: &str) -> bool {
        self.columns.iter().any(|name| name == column)
    }

    /// What identifies an atom, a residue or a chain, with slashes between: the columns whose names end so.
    pub fn label(&self, row: usize, end: &str) -> String {
        let text = |column: &str| self.text(row, &format!("{column}{end}"));
        let mut label = text("chain").to_string();
        if self.has(&format!("residue_name{end}")) {
            label +=
                &format!("/{}/{}{}", text("residue_name"), text("residue_number"), text("insertion_code"));
        }
        if self.has(&format!("atom_name{end}")) {
            label += &format!("/{}", text("atom_name"));
            label += &if text("altloc").is_empty() { String::new() } else { format!("/{}", text("altloc")) };
        }
        label
    }

    /// The row of the file whose name ends so.
    pub fn of_file(&self, name: &str) -> usize {
        let is_it = |&row: &usize| self.text(row, "file").ends_with(name);
        (0..self.len()).find(is_it).unwrap_or_else(|| panic!("no row of {name}: {:?}", self.rows))
    }
}
