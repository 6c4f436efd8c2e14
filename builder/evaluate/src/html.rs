//! The report as one page: no script, no font, no picture from elsewhere.

use std::fmt::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::document::{Agreement, Cell, Document, SectionReport, Table, Verdict};
use super::escape::escape;

/// The page of a report; where `files`, it links to the tables' CSV files beside it.
#[must_use]
pub fn page(document: &Document, files: bool) -> String {
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{}</style>\n</head>\n<body>\n<main>\n<header>\n<h1>{title}</h1>\n<p class=\"lead\">{}</p>\n",
        include_str!("page.css"),
        escape(&document.lead),
        title = escape(&document.title),
    );
    html.push_str("<dl class=\"facts\">\n");
    for (name, value) in &document.facts {
        let _ = writeln!(html, "<div><dt>{}</dt><dd>{}</dd></div>", escape(name), escape(value));
    }
    html.push_str("</dl>\n");
    contents(&mut html, document);
    html.push_str("</header>\n");
    summary(&mut html, document);
    for section in &document.sections {
        write_section(&mut html, section, files);
    }
    html.push_str("</main>\n</body>\n</html>\n");
    html
}

fn contents(html: &mut String, document: &Document) {
    html.push_str("<nav aria-label=\"Sections\"><ol>\n");
    for section in &document.sections {
        let number = section.number;
        let _ = writeln!(html, "<li value=\"{number}\"><a href=\"#s{number}\">{}</a></li>", escape(&section.title));
    }
    html.push_str("</ol></nav>\n");
}

/// All that agrees with the papers and all that does not, on one screen.
fn summary(html: &mut String, document: &Document) {
    let sections = || document.sections.iter().filter(|section| !section.agreements.is_empty());
    if sections().next().is_none() {
        return;
    }
    html.push_str("<section>\n<h2>Agreement with the papers</h2>\n<div class=\"scroll\"><table class=\"agreement\">\n");
    html.push_str(
        "<thead><tr><th>Section</th><th>The papers</th><th>Here</th><th>Verdict</th></tr></thead>\n<tbody>\n",
    );
    for section in sections() {
        for agreement in &section.agreements {
            let _ = writeln!(
                html,
                "<tr><td><a href=\"#s{0}\">{0}</a></td><td>{1}</td><td>{2}</td><td>{3}</td></tr>",
                section.number,
                escape(&agreement.papers),
                escape(&agreement.found),
                verdict(agreement.verdict)
            );
        }
    }
    html.push_str("</tbody></table></div>\n</section>\n");
}

fn verdict(verdict: Verdict) -> String {
    let class = match verdict {
        Verdict::Holds => "holds",
        Verdict::Direction => "direction",
        Verdict::Fails => "fails",
        Verdict::Missing => "missing",
    };
    format!("<span class=\"verdict {class}\">{}</span>", verdict.words())
}

fn write_section(html: &mut String, section: &SectionReport, files: bool) {
    let _ = writeln!(
        html,
        "<section id=\"s{0}\">\n<h2><span class=\"number\">{0}</span> {1}</h2>",
        section.number,
        escape(&section.title)
    );
    if let Some(missing) = &section.missing {
        let _ = writeln!(html, "<p><strong>Missing.</strong> {}</p>", escape(missing));
    }
    for paragraph in &section.text {
        let _ = writeln!(html, "<p>{}</p>", escape(paragraph));
    }
    // What holds is told once, at the top.
    for agreement in section.agreements.iter().filter(|agreement| !agreement.why.is_empty()) {
        write_agreement(html, agreement);
    }
    for table in &section.tables {
        write_table(html, table, files);
    }
    if !section.plots.is_empty() {
        html.push_str("<div class=\"plots\">\n");
        for plot in &section.plots {
            let _ =
                writeln!(html, "<figure>\n{}<figcaption>{}</figcaption>\n</figure>", plot.svg(), escape(&plot.caption));
        }
        html.push_str("</div>\n");
    }
    if !section.pictures.is_empty() {
        html.push_str("<div class=\"pictures\">\n");
        for picture in &section.pictures {
            let [width, height] = picture.size;
            let _ = writeln!(
                html,
                "<figure><img width=\"{width}\" height=\"{height}\" alt=\"{0}\" src=\"data:image/png;base64,{1}\">\
                 <figcaption>{0}</figcaption></figure>",
                escape(&picture.caption),
                STANDARD.encode(&picture.png)
            );
        }
        html.push_str("</div>\n");
    }
    html.push_str("</section>\n");
}

fn write_agreement(html: &mut String, agreement: &Agreement) {
    let _ = writeln!(
        html,
        "<p class=\"claim\">{} <span class=\"papers\">Papers: {}</span> <span>Here: {}</span>{}</p>",
        verdict(agreement.verdict),
        escape(&agreement.papers),
        escape(&agreement.found),
        if agreement.why.is_empty() { String::new() } else { format!(" <em>{}</em>", escape(&agreement.why)) }
    );
}

fn write_table(html: &mut String, table: &Table, files: bool) {
    let file = if files { format!(" <a href=\"{0}.csv\">{0}.csv</a>", table.name) } else { String::new() };
    let _ = write!(
        html,
        "<p class=\"caption\">{}{file}</p>\n<div class=\"scroll\"><table>\n<thead><tr>",
        escape(&table.caption)
    );
    for column in &table.columns {
        let _ = write!(html, "<th>{}</th>", escape(column));
    }
    html.push_str("</tr></thead>\n<tbody>\n");
    for row in &table.rows {
        html.push_str("<tr>");
        for cell in row {
            let class = if matches!(cell, Cell::Text(_)) { "" } else { " class=\"n\"" };
            let _ = write!(html, "<td{class}>{}</td>", escape(&cell.shown()));
        }
        html.push_str("</tr>\n");
    }
    html.push_str("</tbody></table></div>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_escapes_into_the_page() {
        let name = "<script>\"&";
        let section = SectionReport { text: vec![name.into()], title: name.into(), ..SectionReport::default() };
        let document = Document { title: name.into(), sections: vec![section], ..Document::default() };
        let html = page(&document, true);
        assert!(!html.contains("<script") && html.contains("&lt;script&gt;&quot;&amp;"));
    }
}
