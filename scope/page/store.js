// The rows of the last minute, in a ring: a column for each channel.

const KEPT = 60000, HEADER_BYTES = 16;

class Store {
  // Between rows that are more than `gap` s apart there are no values.
  constructor(channels, estimators, gap) {
    this.names = [...channels.map((c) => c.name), ...estimators.map((e) => "estimate:" + e.name)];
    this.column = Object.fromEntries(this.names.map((name, k) => [name, k]));
    this.width = this.names.length;
    this.gap = gap;
    this.time = new Float64Array(KEPT);
    this.values = this.names.map(() => new Float32Array(KEPT));
    this.lost = 0;
    this.epoch = null;
    this.clear();
  }

  clear() { this.count = 0; this.next = null; this.version = (this.version ?? 0) + 1; }

  // Takes a batch of the server: rows, epoch, number of the first row, values.
  take(buffer) {
    const view = new DataView(buffer);
    const rows = view.getUint32(0, true), epoch = view.getUint32(4, true), first = view.getFloat64(8, true);
    if (epoch !== this.epoch) { this.clear(); this.epoch = epoch; }
    if (this.next !== null && first > this.next) this.lost += first - this.next;
    this.next = first + rows;
    const values = new Float64Array(buffer, HEADER_BYTES);
    for (let r = 0; r < rows; r++) {
      const at = this.count % KEPT, from = r * this.width;
      // A board that was replaced may begin before the last row.
      if (this.count && values[from] < this.time[(this.count - 1) % KEPT]) { this.clear(); }
      const to = this.count === 0 ? 0 : at;
      this.time[to] = values[from];
      for (let c = 1; c < this.width; c++) this.values[c][to] = values[from + c];
      this.count++;
    }
  }

  get first() { return Math.max(0, this.count - KEPT); }
  get end() { return this.count ? this.time[(this.count - 1) % KEPT] : 0; }

  // The latest value of a channel.
  latest(name) {
    return this.count ? this.values[this.column[name]][(this.count - 1) % KEPT] : NaN;
  }

  // Number of the first row at or after a time.
  search(t) {
    let low = this.first, high = this.count;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time[middle % KEPT] < t) low = middle + 1; else high = middle;
    }
    return low;
  }

  // Columns for a plot from `from` to `to`, at most two points a bucket: the least and the largest
  // value, in their order, so that no peak is lost. A gap has a point without values.
  decimate(series, from, to, buckets) {
    const begin = Math.max(this.first, this.search(from) - 1);
    const end = Math.min(this.count, this.search(to) + 1);
    const size = Math.max(1, Math.ceil((end - begin) / buckets));
    const t = [], out = series.map(() => []);
    const time = (k) => this.time[k % KEPT], isGap = (k) => time(k) - time(k - 1) > this.gap;
    for (let b = begin, stop; b < end; b = stop) {
      if (b > begin && isGap(b)) { t.push((time(b - 1) + time(b)) / 2); for (const values of out) values.push(null); }
      for (stop = b + 1; stop < Math.min(end, b + size) && !isGap(stop);) stop++;
      if (stop - b < 3) {
        for (let k = b; k < stop; k++) {
          t.push(this.time[k % KEPT]);
          series.forEach((get, s) => out[s].push(finite(get(k % KEPT))));
        }
        continue;
      }
      t.push(this.time[b % KEPT], this.time[((b + stop) >> 1) % KEPT]);
      series.forEach((get, s) => {
        let least = Infinity, most = -Infinity, leastAt = 0, mostAt = 0;
        for (let k = b; k < stop; k++) {
          const value = get(k % KEPT);
          if (value < least) { least = value; leastAt = k; }
          if (value > most) { most = value; mostAt = k; }
        }
        if (least > most) out[s].push(null, null);
        else if (leastAt <= mostAt) out[s].push(least, most);
        else out[s].push(most, least);
      });
    }
    return [t, ...out];
  }
}

function finite(value) { return Number.isFinite(value) ? value : null; }
