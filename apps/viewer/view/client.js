// Draws the pictures that come over the socket, and sends the motions of the mouse.
(function () {
  let socket, canvas, pending = null, last = null, times = [];
  let shown = -1, touched = null, delays = [], wrote = 0, stamp = 0;
  window.pelFrames = 0;
  window.pelDelays = [];
  // The first touch after the picture that shows all touches before it.
  function touch() { if (touched === null) touched = performance.now(); }
  document.addEventListener('pointerdown', (e) => { if (e.target.closest('.q-slider')) touch(); }, true);
  document.addEventListener('pointermove', (e) => {
    if (e.buttons && e.target.closest('.q-slider')) touch();
  }, true);
  // Motions between two pictures are added up: each takes the server's time from the next picture.
  let queued = null;
  function flush() { if (queued) say(queued); queued = null; }
  function say(message) { if (socket && socket.readyState === 1) socket.send(JSON.stringify(message)); }
  function size() {
    if (!canvas) return;
    const r = canvas.getBoundingClientRect(), s = Math.min(1, 1600 / Math.max(r.width, 1));
    say({kind: 'size', width: Math.round(r.width * s), height: Math.round(r.height * s)});
  }
  function connect() {
    socket = new WebSocket((location.protocol === 'https:' ? 'wss://' : 'ws://') + location.host + '/frames');
    socket.binaryType = 'arraybuffer';
    socket.onopen = size;
    socket.onclose = () => setTimeout(connect, 1000);
    socket.onmessage = async (event) => {
      if (typeof event.data === 'string') {
        const message = JSON.parse(event.data);
        if ('busy' in message) {
          const busy = document.getElementById('pel-busy');
          busy.style.display = message.busy ? 'block' : 'none';
          busy.textContent = message.busy;
          return;
        }
        if ('probe' in message) { showProbe(message.probe); return; }
        pending = message;
        document.getElementById('pel-error').style.display = pending.error ? 'block' : 'none';
        document.getElementById('pel-message').textContent = pending.error;
        if (pending.error) say({kind: 'taken'});
        return;
      }
      const head = pending, picture = await createImageBitmap(new Blob([event.data], {type: 'image/jpeg'}));
      // As large as the picture: scaling by the browser's compositor costs less than drawing at full size.
      if (canvas.width !== picture.width || canvas.height !== picture.height) {
        canvas.width = picture.width;
        canvas.height = picture.height;
      }
      canvas.getContext('2d', {alpha: false}).drawImage(picture, 0, 0);
      picture.close();
      const now = performance.now();
      times = times.filter((t) => now - t < 1000).concat(now);
      if (touched !== null && head.changes > shown) {  // from the hand to the picture
        delays = delays.slice(-19).concat(now - touched);
        window.pelDelays.push(now - touched);
        touched = null;
      }
      if (head.at !== stamp && head.at <= now) delays = delays.slice(-19).concat(now - head.at);
      stamp = head.at;
      window.pelFrames += 1;
      window.pelMoving = head.moving;
      window.pelStandsIn = head.standsIn;
      window.pelSample = head.sample;
      window.pelRate = times.length;
      window.pelKernels = head.kernels;
      if (now - wrote > 250 || !head.moving) {
        wrote = now;
        const median = [...delays].sort((a, b) => a - b)[delays.length >> 1];
        const delay = delays.length ? ', ' + median.toFixed(0) + ' ms latency' : '';
        document.getElementById('pel-rate').textContent = head.width + ' x ' + head.height + ', ' +
          Object.entries(head.milliseconds).map(([k, v]) => k + ' ' + v.toFixed(0) + ' ms').join(', ') +
          (head.moving ? ', ' + times.length + ' frames/s' : '') + delay + ', ' +
          head.kernels + ' kernels compiled (' + head.compiled + ' now)' +
          (head.standsIn ? '; scattering follows when its kernels are built' : '');
      }
      if (head.changes > shown) askProbe(null);
      shown = head.changes;
      showScale(head.scale);
      if (head.histogram || head.sample === 0 && !head.moving) showHistogram(head.histogram);
      say({kind: 'taken'});
      flush();
    };
  }
  function showScale(scale) {
    document.getElementById('pel-scale').style.display = scale ? 'block' : 'none';
    if (!scale) return;
    document.getElementById('pel-bar').style.background = 'linear-gradient(to right,' + scale.colors.join(',') + ')';
    document.getElementById('pel-low').textContent = scale.low;
    document.getElementById('pel-high').textContent = scale.high;
  }
  function showHistogram(counts) {
    const chart = document.getElementById('pel-histogram');
    chart.style.display = counts ? 'block' : 'none';
    if (!counts) return;
    const context = chart.getContext('2d'), highest = Math.max(1, ...counts.flat());
    context.clearRect(0, 0, chart.width, chart.height);
    context.globalCompositeOperation = 'lighter';
    counts.forEach((channel, c) => {
      context.fillStyle = ['#c33', '#3a3', '#46e'][c];
      channel.forEach((count, i) => {  // square roots: few pixels are seen too
        const height = chart.height * Math.sqrt(count / highest);
        context.fillRect(i * chart.width / channel.length, chart.height - height, chart.width / channel.length, height);
      });
    });
  }
  // The facts of the pixel below the mouse, which rests.
  let asked = null, pointer = null;
  function askProbe(e) {
    if (e) pointer = {x: e.offsetX, y: e.offsetY};
    if (!pointer) return;
    showProbe('');
    clearTimeout(asked);
    asked = setTimeout(() => say({kind: 'probe', x: pointer.x / canvas.clientWidth, y: pointer.y / canvas.clientHeight}), 120);
  }
  function showProbe(text) {
    const box = document.getElementById('pel-probe');
    box.style.display = text && pointer ? 'block' : 'none';
    box.textContent = text;
    if (!text || !pointer) return;
    const right = pointer.x > canvas.clientWidth / 2, low = pointer.y > canvas.clientHeight / 2;
    box.style.left = right ? '' : pointer.x + 14 + 'px';
    box.style.right = right ? canvas.clientWidth - pointer.x + 14 + 'px' : '';
    box.style.top = low ? '' : pointer.y + 14 + 'px';
    box.style.bottom = low ? canvas.clientHeight - pointer.y + 14 + 'px' : '';
  }
  function start() {
    canvas = document.getElementById('pel-canvas');
    if (!canvas) { setTimeout(start, 50); return; }
    new ResizeObserver(size).observe(canvas);
    function move(kind, dx, dy) {
      if (queued && queued.kind === kind) { queued.dx += dx; queued.dy += dy; return; }
      flush();
      queued = {kind: kind, dx: dx, dy: dy, at: performance.now()};
      setTimeout(flush, 25);
    }
    canvas.addEventListener('contextmenu', (e) => e.preventDefault());
    canvas.addEventListener('pointerdown', (e) => { last = e; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener('pointerup', () => { last = null; });
    canvas.addEventListener('pointerleave', () => { pointer = null; clearTimeout(asked); showProbe(''); });
    canvas.addEventListener('dblclick', (e) => {
      say({kind: 'pivot', x: e.offsetX / canvas.clientWidth, y: e.offsetY / canvas.clientHeight});
    });
    canvas.addEventListener('pointermove', (e) => {
      if (!last) { askProbe(e); return; }
      const h = canvas.clientHeight, dx = (e.clientX - last.clientX) / h, dy = (e.clientY - last.clientY) / h;
      const pan = e.shiftKey || (e.buttons & 2);
      const kind = e.ctrlKey || e.metaKey ? (e.shiftKey ? 'surroundings' : 'light') : pan ? 'pan' : e.altKey ? 'wipe' : 'orbit';
      last = e;
      if (kind === 'wipe') say({kind: 'wipe', x: e.offsetX / canvas.clientWidth}); else move(kind, dx, dy);
    });
    canvas.addEventListener('wheel', (e) => {
      e.preventDefault();
      move('zoom', 0, Math.sign(e.deltaY) * 0.1);
    }, {passive: false});
    document.getElementById('pel-again').addEventListener('click', () => say({kind: 'restart'}));
    connect();
  }
  start();
})();
