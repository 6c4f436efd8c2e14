//! A small static file server for `dist/`, for this machine only.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};

use anyhow::{Context, Result, bail};

use crate::command::root;

const DEFAULT_PORT: u16 = 8000;

/// The strictest policy that the pages run under, so that trouble with it shows here first; `blob:` is where the page of key poses
/// has the files that it opens.
const POLICY: &str = "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; \
                      img-src 'self' blob: data:; connect-src * blob:";

/// `cargo xtask serve [--port N]`.
pub fn serve_command(arguments: &[&str]) -> Result<()> {
    let port = match arguments {
        [] => None,
        ["--port", port] => Some(port.parse().with_context(|| format!("{port:?} is not a port"))?),
        _ => bail!("usage: cargo xtask serve [--port N]"),
    };
    serve(&root().join("dist"), port)
}

/// Serves `folder` until the process ends. Without a port, the first free one from 8000 on is taken.
pub fn serve(folder: &Path, port: Option<u16>) -> Result<()> {
    if !folder.join("index.html").is_file() {
        bail!("{} holds no page; build it with: cargo xtask web", folder.display());
    }
    let listener = match port {
        Some(port) => listen(port).with_context(|| format!("port {port} is not free"))?,
        None => (DEFAULT_PORT..DEFAULT_PORT + 100).find_map(|port| listen(port).ok()).context("no port is free")?,
    };
    println!("\nReprise is at http://localhost:{}/  (Ctrl+C ends it)", listener.local_addr()?.port());
    for stream in listener.incoming() {
        let folder = folder.to_path_buf();
        // A visitor that hangs up early is no trouble of ours.
        std::thread::spawn(move || stream.map(|stream| answer(stream, &folder)));
    }
    Ok(())
}

fn listen(port: u16) -> std::io::Result<TcpListener> {
    TcpListener::bind((Ipv4Addr::LOCALHOST, port))
}

fn answer(mut stream: TcpStream, folder: &Path) -> std::io::Result<()> {
    let mut reader = BufReader::new(stream.try_clone()?).take(16 * 1024);
    let mut request = String::new();
    reader.read_line(&mut request)?;
    let mut header = String::new();
    while reader.read_line(&mut header)? > 2 {
        header.clear();
    }
    let mut words = request.split(' ');
    let (method, target) = (words.next().unwrap_or(""), words.next().unwrap_or(""));
    let file = (method == "GET").then(|| file_of(folder, target)).flatten();
    let body = file.as_ref().and_then(|file| fs::read(file).ok());
    let (status, kind, body) = match (&file, body) {
        (Some(file), Some(body)) => ("200 OK", media_type(file), body),
        _ => ("404 Not Found", "text/plain; charset=utf-8", b"There is no such file.".to_vec()),
    };
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nCache-Control: no-cache\r\n\
         Content-Security-Policy: {POLICY}\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        body.len()
    )?;
    stream.write_all(&body)
}

/// The file that a request's target names, never outside of `folder`.
fn file_of(folder: &Path, target: &str) -> Option<PathBuf> {
    let path = target.split(['?', '#']).next()?.trim_start_matches('/');
    let path = Path::new(if path.is_empty() { "index.html" } else { path });
    let plain = path.components().all(|part| matches!(part, Component::Normal(_)));
    plain.then(|| folder.join(path)).filter(|file| file.is_file())
}

fn media_type(file: &Path) -> &'static str {
    match file.extension().and_then(|extension| extension.to_str()).unwrap_or("") {
        "html" => "text/html; charset=utf-8",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "css" => "text/css; charset=utf-8",
        "json" => "application/json",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "wasm" => "application/wasm",
        "ts" => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
