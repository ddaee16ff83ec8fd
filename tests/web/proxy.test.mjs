// The page behind proxies, under a path, and in frames of other sites.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import http from 'node:http';
import https from 'node:https';
import net from 'node:net';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { after, before, test } from 'node:test';
import { launch, message, open, scratch, seen, serve, stopAll, until } from './harness.mjs';

let browser, server;
const open_servers = [];
const scene = 'builtin:knot?tubular=60&radial=12';
const packaging = fileURLToPath(new URL('../../packaging', import.meta.url));

before(async () => {
  browser = await launch();
  server = await serve(scene);
});
after(async () => {
  for (const one of open_servers) { one.closeAllConnections?.(); one.close(); }
  await browser?.close();
  await server?.stop();
  stopAll();
});

function certificate() {
  const folder = scratch();
  execFileSync('openssl', ['req', '-x509', '-newkey', 'rsa:2048', '-nodes', '-days', '2', '-subj', '/CN=localhost',
    '-keyout', join(folder, 'key.pem'), '-out', join(folder, 'cert.pem')], { stdio: 'ignore' });
  return { key: readFileSync(join(folder, 'key.pem')), cert: readFileSync(join(folder, 'cert.pem')) };
}

// Passes requests and upgrades on. `path` is taken off; `headers` may rewrite a request's headers.
async function proxy(to, { path = '/', tls, headers = (h) => h } = {}) {
  const inside = (url) => '/' + url.slice(path.length);
  const answer = (request, reply) => {
    if (!request.url.startsWith(path)) { reply.writeHead(404).end(); return; }
    const onward = http.request({ port: to, path: inside(request.url), method: request.method, headers: headers(request.headers) },
      (back) => { reply.writeHead(back.statusCode, back.headers); back.pipe(reply); });
    onward.on('error', () => reply.destroy());
    request.pipe(onward);
  };
  const one = tls ? https.createServer(tls, answer) : http.createServer(answer);
  one.on('upgrade', (request, socket) => {
    const onward = net.connect(to, '127.0.0.1', () => {
      const lines = Object.entries(headers(request.headers)).map(([name, value]) => `${name}: ${value}\r\n`).join('');
      onward.write(`GET ${inside(request.url)} HTTP/1.1\r\n${lines}\r\n`);
      onward.pipe(socket).pipe(onward);
    });
    for (const end of [onward, socket]) end.on('error', () => { onward.destroy(); socket.destroy(); });
  });
  await new Promise((done) => { one.listen(0, '127.0.0.1', done); });
  open_servers.push(one);
  return `${tls ? 'https' : 'http'}://127.0.0.1:${one.address().port}${path}`;
}

test('a path of a proxy serves the page and its connection', async () => {
  const page = await open(browser, await proxy(server.port, { path: '/render/' }));
  await seen(page);
  await page.context().close();
});

test('a proxy that ends TLS and rewrites Host says what the browser called', async () => {
  const url = await proxy(server.port, {
    tls: certificate(),
    headers: (h) => ({ ...h, host: 'mirage', 'x-forwarded-host': h.host, 'x-forwarded-proto': 'https', 'x-forwarded-for': '192.0.2.7' }) });
  const page = await open(browser, url, { ignoreHTTPSErrors: true });
  await seen(page);
  await page.context().close();
});

test('a proxy that rewrites Host and says nothing is told in the log and on the page', async () => {
  const url = await proxy(server.port, { headers: (h) => ({ ...h, host: 'mirage' }) });
  const page = await open(browser, url);
  await until('the log to say so', () => server.log.join('').includes(`--allow-origin ${new URL(url).origin}`));
  assert.match(await until('a message', () => message(page)), /does not let this page in/);
  await page.context().close();
});

test('a page of another site shows this one in a frame only if it is named', async () => {
  const portal = http.createServer((request, reply) => {
    reply.writeHead(200, { 'content-type': 'text/html' });
    reply.end(`<!doctype html><iframe src="${new URL(request.url, 'http://x').searchParams.get('of')}" width="400" height="300"></iframe>`);
  });
  await new Promise((done) => { portal.listen(0, '127.0.0.1', done); });
  open_servers.push(portal);
  const origin = `http://127.0.0.1:${portal.address().port}`;
  const named = await serve(scene, ['--embed-origin', 'https://other.example', '--embed-origin', origin]);
  const framed = async (url) => {
    const page = await open(browser, `${origin}/?of=${encodeURIComponent(url)}`);
    const frame = await until('the frame', () => page.frames()[1]);
    return { page, frame };
  };
  const shown = await framed(named.url);
  await until('a picture in the frame', () => shown.frame.evaluate(() => Boolean(globalThis.mirage?.seen)).catch(() => false));
  const blocked = await framed(server.url);
  await until('the browser to refuse', () => blocked.page.problems.some((text) => /frame-ancestors/.test(text)));
  await shown.page.context().close();
  await blocked.page.context().close();
  await named.stop();
});

// The files that the package has for the usual proxies, with the ports of this test.
const proxies = [
  { program: 'nginx', file: 'nginx/viewer.conf', args: (folder, file) => ['-p', folder, '-c', file, '-g', 'daemon off;'] },
  { program: 'haproxy', file: 'haproxy/viewer.cfg', args: (folder, file) => ['-f', file] },
  { program: 'caddy', file: 'caddy/Caddyfile', args: (folder, file) => ['run', '--config', file, '--adapter', 'caddyfile'] },
];
const there = (program) => {
  try { execFileSync('sh', ['-c', `PATH=$PATH:/usr/sbin command -v ${program}`]); return true; } catch { return false; }
};

for (const { program, file, args } of proxies) {
  test(`${program} with the file of the package ends TLS and serves the page under a path`, { skip: !there(program) && `no ${program}` }, async () => {
    const folder = scratch();
    const { key, cert } = certificate();
    writeFileSync(join(folder, 'mirage.pem'), Buffer.concat([cert, key]));
    const free = net.createServer().listen(0, '127.0.0.1');
    await until('a free port', () => free.address());
    const { port } = free.address();
    await new Promise((done) => { free.close(done); });
    const text = readFileSync(join(packaging, file), 'utf8').replaceAll('9870', server.port).replaceAll('8443', port);
    const config = join(folder, 'config');
    writeFileSync(config, text);
    const child = spawn(program, args(folder, config),
      { cwd: folder, env: { ...process.env, PATH: `${process.env.PATH}:/usr/sbin`, HOME: folder }, stdio: ['ignore', 'pipe', 'pipe'] });
    const log = [];
    for (const stream of [child.stdout, child.stderr]) stream.on('data', (line) => log.push(String(line)));
    try {
      await until(`${program}: ${log.join('')}`, () => new Promise((done) => {
        const probe = net.connect(port, '127.0.0.1', () => { probe.destroy(); done(true); });
        probe.on('error', () => done(false));
      }));
      const page = await open(browser, `https://127.0.0.1:${port}/render/`, { ignoreHTTPSErrors: true });
      await seen(page);
      await page.context().close();
    } finally {
      child.kill('SIGKILL');
    }
  });
}
