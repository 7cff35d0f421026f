//! Conditions on points, such as `value > 0.3 and (t == 2 or x < y)`.

use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

use spmesh_base::limits::{CONDITION_DEPTH_MAX, CONDITION_LEN_MAX};
use spmesh_stream::model::cells4::Point4;

/// A condition that points can fulfil.
#[derive(Debug, Clone, PartialEq)]
pub struct Condition {
    text: String,
    rule: Rule,
}

#[derive(Debug, Clone, PartialEq)]
enum Rule {
    Comparison(Term, Relation, Term),
    All(Vec<Rule>),
    Any(Vec<Rule>),
}

/// One side of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Term {
    Number(f64),
    /// x, y, z or t.
    Coordinate(usize),
    Value,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Relation {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
}

impl Condition {
    /// Whether a point with this value fulfils the condition. Comparisons with NaN are false.
    pub fn holds(&self, point: &Point4, value: f64) -> bool {
        self.rule.holds(point, value)
    }

    /// Whether the condition uses values.
    pub fn needs_value(&self) -> bool {
        self.rule.needs_value()
    }
}

impl Rule {
    fn holds(&self, point: &Point4, value: f64) -> bool {
        match self {
            Rule::Comparison(left, relation, right) => {
                let of = |term: &Term| match *term {
                    Term::Number(number) => number,
                    Term::Coordinate(axis) => point[axis],
                    Term::Value => value,
                };
                of(left).partial_cmp(&of(right)).is_some_and(|ordering| relation.holds(ordering))
            }
            Rule::All(rules) => rules.iter().all(|rule| rule.holds(point, value)),
            Rule::Any(rules) => rules.iter().any(|rule| rule.holds(point, value)),
        }
    }

    fn needs_value(&self) -> bool {
        match self {
            Rule::Comparison(left, _, right) => *left == Term::Value || *right == Term::Value,
            Rule::All(rules) | Rule::Any(rules) => rules.iter().any(Rule::needs_value),
        }
    }
}

impl Relation {
    fn holds(self, ordering: Ordering) -> bool {
        match self {
            Relation::Less => ordering.is_lt(),
            Relation::LessOrEqual => ordering.is_le(),
            Relation::Greater => ordering.is_gt(),
            Relation::GreaterOrEqual => ordering.is_ge(),
            Relation::Equal => ordering.is_eq(),
            Relation::NotEqual => ordering.is_ne(),
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// The error names the column, counted from 1.
impl FromStr for Condition {
    type Err = String;

    fn from_str(text: &str) -> Result<Condition, String> {
        if text.len() > CONDITION_LEN_MAX {
            return Err(format!("longer than {CONDITION_LEN_MAX} bytes"));
        }
        let mut parser = Parser { text, at: 0, depth: 0 };
        let rule = parser.any()?;
        match parser.peek() {
            "" => Ok(Condition { text: text.to_string(), rule }),
            _ => Err(parser.expected("and, or, or the end")),
        }
    }
}

/// Reads a condition by recursive descent.
struct Parser<'t> {
    text: &'t str,
    /// Offset in bytes of what comes next.
    at: usize,
    /// Number of open parentheses.
    depth: usize,
}

impl<'t> Parser<'t> {
    /// Conjunctions joined by `or`.
    fn any(&mut self) -> Result<Rule, String> {
        self.joined("or", Self::all, Rule::Any)
    }

    fn all(&mut self) -> Result<Rule, String> {
        self.joined("and", Self::one, Rule::All)
    }

    /// One or more rules with `word` between them.
    fn joined(
        &mut self,
        word: &str,
        rule: fn(&mut Self) -> Result<Rule, String>,
        join: fn(Vec<Rule>) -> Rule,
    ) -> Result<Rule, String> {
        let first = rule(self)?;
        if self.peek() != word {
            return Ok(first);
        }
        let mut rules = vec![first];
        while self.peek() == word {
            self.take();
            rules.push(rule(self)?);
        }
        Ok(join(rules))
    }

    /// A comparison, or a condition in parentheses.
    fn one(&mut self) -> Result<Rule, String> {
        if self.peek() != "(" {
            let left = self.term()?;
            let relation = self.relation()?;
            return Ok(Rule::Comparison(left, relation, self.term()?));
        }
        self.depth += 1;
        if self.depth > CONDITION_DEPTH_MAX {
            return Err(self.expected(&format!("at most {CONDITION_DEPTH_MAX} parentheses in each other")));
        }
        self.take();
        let rule = self.any()?;
        if self.peek() != ")" {
            return Err(self.expected("and, or, or )"));
        }
        self.take();
        self.depth -= 1;
        Ok(rule)
    }

    fn term(&mut self) -> Result<Term, String> {
        let term = match self.peek() {
            "x" => Some(Term::Coordinate(0)),
            "y" => Some(Term::Coordinate(1)),
            "z" => Some(Term::Coordinate(2)),
            "t" => Some(Term::Coordinate(3)),
            "value" => Some(Term::Value),
            // Rust parses "nan" and "inf" as numbers. NaN is rejected, since every comparison with it is
            // false.
            word => word.parse().ok().filter(|number: &f64| !number.is_nan()).map(Term::Number),
        };
        let term = term.ok_or_else(|| self.expected("value, x, y, z, t, or a number"))?;
        self.take();
        Ok(term)
    }

    fn relation(&mut self) -> Result<Relation, String> {
        let relation = match self.peek() {
            "<" => Relation::Less,
            "<=" => Relation::LessOrEqual,
            ">" => Relation::Greater,
            ">=" => Relation::GreaterOrEqual,
            "==" => Relation::Equal,
            "!=" => Relation::NotEqual,
            _ => return Err(self.expected("<, <=, >, >=, == or !=")),
        };
        self.take();
        Ok(relation)
    }

    /// The next token: a word or number, a comparison operator, or a single character; empty at the end.
    fn peek(&self) -> &'t str {
        let rest = self.text[self.at..].trim_start();
        let len_while = |is: fn(char) -> bool| rest.find(|c| !is(c)).unwrap_or(rest.len());
        let is_sign = |c: char| matches!(c, '<' | '>' | '=' | '!');
        let len = match rest.chars().next() {
            None => 0,
            Some(c) if is_sign(c) => len_while(is_sign),
            Some(c) if is_word(c) => word_len(rest),
            Some(c) => c.len_utf8(),
        };
        &rest[..len]
    }

    /// Skips the next token.
    fn take(&mut self) {
        self.at = self.start() + self.peek().len();
    }

    /// Offset in bytes at which the next token starts.
    fn start(&self) -> usize {
        let rest = &self.text[self.at..];
        self.at + rest.len() - rest.trim_start().len()
    }

    fn expected(&self, expected: &str) -> String {
        let column = self.text[..self.start()].chars().count() + 1;
        let found = match self.peek() {
            "" => "the end".to_string(),
            found => format!("{found:?}"),
        };
        format!("column {column}: found {found}, expected {expected}")
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '.' | '_' | '+' | '-')
}

/// Length of the word or number that `text` starts with. A sign is part of it only at the start and after the
/// `e` of a number.
fn word_len(text: &str) -> usize {
    let mut before = None;
    for (at, c) in text.char_indices() {
        let is_sign = matches!(c, '+' | '-');
        let is_exponent =
            matches!(before, Some('e' | 'E')) && text[..at].contains(|c: char| c.is_ascii_digit());
        if !is_word(c) || is_sign && at > 0 && !is_exponent {
            return at;
        }
        before = Some(c);
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holds(text: &str) -> bool {
        let condition: Condition = text.parse().unwrap_or_else(|e| panic!("{text}: {e}"));
        condition.holds(&[1.0, 2.0, 3.0, 4.0], 0.5)
    }

    #[test]
    fn comparisons_are_what_they_say() {
        for text in [
            "value>0.3",
            "value >= .5",
            "value<=0.5",
            "value<1",
            "value==5e-1",
            "value != 0.4",
            "x==1 and y==2",
            "z==3 and t==4",
            "1<x or x<2",
            "x>5 or y>5 or t>3",
            "x>5 or y==2 and z==3",
            "(x==1 or y==9) and z==3",
            "x>-1e+3 and value<inf",
            "((x<y))",
        ] {
            assert!(holds(text), "{text}");
        }
        for text in
            ["value>0.5", "x!=1", "x==1 and y==1", "x>5 or y>5", "(x==1 or y==9) and z==4", "x<-1", "y<x"]
        {
            assert!(!holds(text), "{text}");
        }
    }

    #[test]
    fn and_binds_stronger_than_or() {
        assert!(holds("x==1 or x==2 and y==9"));
        assert!(!holds("(x==1 or x==2) and y==9"));
    }

    #[test]
    fn nothing_is_true_of_a_missing_value() {
        for text in ["value>0", "value<=0", "value!=0", "value==value"] {
            assert!(!text.parse::<Condition>().unwrap().holds(&[0.0; 4], f64::NAN), "{text}");
        }
        assert!("value>0 or t==0".parse::<Condition>().unwrap().holds(&[0.0; 4], f64::NAN));
    }

    #[test]
    fn conditions_know_whether_they_need_values() {
        assert!("x>1 and (t<2 or 3>value)".parse::<Condition>().unwrap().needs_value());
        assert!(!"x>1 or t<2".parse::<Condition>().unwrap().needs_value());
    }

    #[test]
    fn errors_name_the_column() {
        for (text, column, found) in [
            ("", 1, "the end"),
            ("value", 6, "the end"),
            ("value = 3", 7, "\"=\""),
            ("value > ", 9, "the end"),
            ("value > three", 9, "\"three\""),
            ("value > nan", 9, "\"nan\""),
            ("w > 3", 1, "\"w\""),
            ("x>1 && y>2", 5, "\"&\""),
            ("x>1 y>2", 5, "\"y\""),
            ("(x>1", 5, "the end"),
            ("x>1)", 4, "\")\""),
            ("0<x<1", 4, "\"<\""),
            ("x<>1", 2, "\"<>\""),
            ("x>1.2.3", 3, "\"1.2.3\""),
            ("x-1>2", 2, "\"-1\""),
            ("\u{e4}\u{f6} > 1", 1, "\"\u{e4}\u{f6}\""),
            ("x > 1 \u{b7} 2", 7, "\"\u{b7}\""),
        ] {
            let error = text.parse::<Condition>().unwrap_err();
            assert!(
                error.starts_with(&format!("column {column}: found {found}, expected ")),
                "{text}: {error}"
            );
        }
    }

    #[test]
    fn long_and_deep_conditions_are_refused() {
        assert!("(".repeat(4000).parse::<Condition>().unwrap_err().contains("parentheses"));
        assert!(
            format!("x>1{}", " and x>1".repeat(1000)).parse::<Condition>().unwrap_err().contains("longer")
        );
        assert!(format!("x>0{}", " and x>0".repeat(400)).parse::<Condition>().is_ok());
    }
}
