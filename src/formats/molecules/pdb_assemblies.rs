//! Biological assemblies in PDB files: REMARK 350.

use crate::molecules::assemblies::{Generator, Operator};
use crate::molecules::builder::StructureBuilder;
use crate::molecules::motion::Motion;

/// Reads the lines of REMARK 350.
#[derive(Debug, Default)]
pub(crate) struct Remark350 {
    /// Names of the assemblies that the lines are about: one, in most files.
    assemblies: Vec<String>,
    /// Number of generators that the next chains and operators belong to: the last ones.
    open: usize,
    /// Name of their first operator.
    first: usize,
    /// Numbers of the operator so far.
    numbers: Vec<String>,
}

impl Remark350 {
    /// Reads the text of a line behind `REMARK 350`.
    pub(crate) fn line(&mut self, text: &str, builder: &mut StructureBuilder) {
        let text = text.trim();
        if let Some(names) = text.strip_prefix("BIOMOLECULE:") {
            self.assemblies = list(names).map(str::to_string).collect();
            self.open = 0;
        } else if let Some((before, chains)) = text.split_once("CHAINS:") {
            if before.contains("APPLY") {
                self.start(builder);
            }
            self.add_chains(chains, builder);
        } else if let Some(row) = text.strip_prefix("BIOMT") {
            self.add_row(row, builder);
        }
    }

    fn start(&mut self, builder: &mut StructureBuilder) {
        (self.open, self.first) = (self.assemblies.len(), builder.assemblies.operators.len() + 1);
        let generator = |assembly: &String| {
            let (subchains, expression) = (Vec::new(), String::new());
            Generator { assembly: assembly.clone(), subchains, expression }
        };
        builder.assemblies.generators.extend(self.assemblies.iter().map(generator));
    }

    fn add_chains(&mut self, chains: &str, builder: &mut StructureBuilder) {
        for name in list(chains) {
            // So older files name the chain without a name.
            let name = builder.intern(if name == "NULL" { "" } else { name });
            self.open(builder).iter_mut().for_each(|generator| generator.subchains.push(name));
        }
    }

    /// Reads a row of an operator: its number, that of the operator, and four numbers. Operators are counted
    /// through the file here: their own numbers start again with each assembly.
    fn add_row(&mut self, row: &str, builder: &mut StructureBuilder) {
        let mut fields = row.split_ascii_whitespace();
        match fields.next() {
            Some("1") => self.numbers.clear(),
            Some("2" | "3") => {}
            _ => return,
        }
        self.numbers.extend(fields.skip(1).map(str::to_string));
        if row.starts_with('3') {
            let (last, motion) = (builder.assemblies.operators.len() + 1, Motion::parse(&self.numbers));
            builder.assemblies.operators.push(Operator { name: last.to_string(), motion });
            let expression = format!("{}-{last}", self.first);
            self.open(builder).iter_mut().for_each(|generator| generator.expression.clone_from(&expression));
            self.numbers.clear();
        }
    }

    fn open<'b>(&self, builder: &'b mut StructureBuilder) -> &'b mut [Generator] {
        let generators = &mut builder.assemblies.generators;
        let start = generators.len().saturating_sub(self.open);
        &mut generators[start..]
    }
}

/// The names of a list with commas.
fn list(text: &str) -> impl Iterator<Item = &str> {
    text.split(',').map(str::trim).filter(|name| !name.is_empty())
}
