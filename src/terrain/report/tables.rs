//! Numbers and tables in HTML.

use std::fmt::Write;

/// From here on, numbers are shown with exponents.
const LARGE: f64 = 1e9;

/// A number with some decimals; a dash if it is not finite.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_string();
    }
    if value.abs() >= LARGE {
        return format!("{value:.3e}");
    }
    let text = format!("{value:.decimals$}");
    let is_zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    if is_zero { text.trim_start_matches('-').to_string() } else { text }
}

/// A count with narrow blanks between thousands.
pub(super) fn whole(count: u64) -> String {
    let digits = count.to_string();
    let mut text = String::new();
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

/// A share in percent.
pub(super) fn percent(share: f64) -> String {
    format!("{} %", fixed(100.0 * share, 2))
}

/// A text, as HTML writes it.
pub(super) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for char in text.chars() {
        match char {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            char if char.is_control() => safe.push('\u{fffd}'),
            char => safe.push(char),
        }
    }
    safe
}

/// A table whose first column has names, and whose others have numbers. `head` and `rows` are text, not HTML.
pub(super) fn table(caption: &str, head: &[&str], rows: &[Vec<String>]) -> String {
    // A table that is wider than the page has a bar of its own, which keys reach.
    let mut html = format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table>\n",
        escaped(caption)
    );
    let _ = writeln!(html, "<caption>{}</caption>", escaped(caption));
    let _ = write!(html, "<thead><tr>");
    head.iter().for_each(|name| html += &format!("<th scope=\"col\">{}</th>", escaped(name)));
    html += "</tr></thead>\n<tbody>\n";
    for row in rows {
        html += "<tr>";
        for (column, cell) in row.iter().enumerate() {
            let cell = escaped(cell);
            html += &if column == 0 {
                format!("<th scope=\"row\">{cell}</th>")
            } else {
                format!("<td>{cell}</td>")
            };
        }
        html += "</tr>\n";
    }
    html + "</tbody></table></div>\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            (fixed(-0.0001, 2), fixed(-1.005e12, 3), fixed(2.5, 1)),
            ("0.00".into(), "-1.005e12".into(), "2.5".into())
        );
        assert_eq!(
            (whole(0), whole(999), whole(1_234_567)),
            ("0".into(), "999".into(), "1\u{202f}234\u{202f}567".into())
        );
        assert_eq!(percent(0.123_456), "12.35 %");
    }

    #[test]
    fn words_of_users_are_no_html() {
        let html = table("<a>", &["\"b\""], &[vec!["<script>".into(), "&\u{7}".into()]]);
        assert!(
            html.contains("&lt;script&gt;") && html.contains("&amp;\u{fffd}") && !html.contains("<script")
        );
    }
}
