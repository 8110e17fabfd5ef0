// SPDX-License-Identifier: Apache-2.0
#pragma once
/// An executor that takes every decision of the text that a GPU takes, on one thread of
/// the host, and whose memory may only be touched inside of kernels: host code that looks
/// into a view dies. It counts what crosses between host and device, and it can run out
/// of memory.

#include "exec/cpu.hpp"
#include "exec/device_buffer.hpp"
#include "exec/device_full.hpp"

#include <algorithm>
#include <cstring>
#include <new>
#include <sys/mman.h>
#include <vector>

namespace noli::test {

/// "Device" memory: closed unless somebody holds an Open.
class DeviceMemory {
  public:
    static void* take(std::size_t bytes) {
        Pool& p = pool();
        const std::size_t begin = p.used;
        const std::size_t pages = (bytes + kPage - 1) / kPage * kPage;
        if (p.used + pages > std::min(kSize, limit()))
            throw DeviceFull(bytes, limit() > p.used ? limit() - p.used : 0, limit());
        p.used += pages;
        ++p.live;
        return p.base + begin;
    }
    /// Memory is only reused once all of it has been given back.
    static void give_back() {
        Pool& p = pool();
        if (--p.live > 0) return;
        mprotect(p.base, p.used, PROT_NONE);
        madvise(p.base, p.used, MADV_DONTNEED);
        p.used = 0;
    }
    /// Bytes that buffers hold now, without their room to grow.
    static std::size_t& asked() {
        static std::size_t asked = 0;
        return asked;
    }
    /// Bytes taken so far.
    static std::size_t used() { return pool().used; }
    /// Taking more than this fails.
    static std::size_t& limit() {
        static std::size_t limit = kSize;
        return limit;
    }

    class Open {
      public:
        Open() {
            if (pool().open++ == 0) protect(PROT_READ | PROT_WRITE);
        }
        ~Open() {
            if (--pool().open == 0) protect(PROT_NONE);
        }
        Open(const Open&) = delete;
        Open& operator=(const Open&) = delete;
    };

  private:
    struct Pool {
        char* base = static_cast<char*>(mmap(nullptr,
                                             kSize,
                                             PROT_NONE,
                                             MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE,
                                             -1,
                                             0));
        std::size_t used = 0;
        int live = 0;  ///< pieces that are in use
        int open = 0;
    };
    static Pool& pool() {
        static Pool pool;
        return pool;
    }
    static void protect(int how) { mprotect(pool().base, pool().used, how); }

    static constexpr std::size_t kPage = 4096;
    static constexpr std::size_t kSize = std::size_t{1}
                                      << 33;  // of addresses, not of memory
};

/// That memory as a DeviceBuffer takes it. New memory holds NaN.
struct ClosedMemory {
    static int room_for(int n) { return 2 * n; }
    static void settle() {}
    static void* take(std::size_t bytes) {
        void* out = DeviceMemory::take(bytes);
        DeviceMemory::asked() += bytes / 2;
        const DeviceMemory::Open open;
        std::memset(out, 0xFF, bytes);
        return out;
    }
    static void give_back(void* /*p*/, std::size_t bytes) {
        DeviceMemory::asked() -= bytes / 2;
        DeviceMemory::give_back();
    }
};

template <class T>
using ClosedBuffer = DeviceBuffer<T, ClosedMemory>;

/// What crossed between host and device.
struct BusTraffic {
    long bytes = 0;
    long largest = 0;   ///< bytes of the largest transfer
    long arriving = 0;  ///< bytes of downloads that nobody waits for at once
    long waits = 0;     ///< of the host for the device: transfers of both directions
    long launches = 0;  ///< loops

    void add(std::size_t size) {
        bytes += static_cast<long>(size);
        largest = std::max(largest, static_cast<long>(size));
        ++waits;
    }
};

class DeviceLikeExec : public LaterNumbers<DeviceLikeExec, ClosedBuffer<double>> {
  public:
    template <class T>
    using Buffer = ClosedBuffer<T>;
    static constexpr bool kIsDevice = true;

    /// Of all executors of this program.
    static BusTraffic& traffic() {
        static BusTraffic traffic;
        return traffic;
    }

    template <class F>
    void for_each(const char* name, int n, F f, int grain = 1) {
        const DeviceMemory::Open open;
        ++traffic().launches;
        host_.for_each(name, n, f, grain);
    }
    template <class F>
    void for_lanes(const char* /*name*/, int n, F f) {
        const DeviceMemory::Open open;
        ++traffic().launches;
        for (int i = 0; i < n; ++i)
            f(Lane<double>{i});
    }
    template <class F>
    void for_warps(const char* name, std::uint32_t n, F f) {
        const DeviceMemory::Open open;
        ++traffic().launches;
        host_.for_warps(name, n, f);
    }
    template <class F, class G>
    void sum_then(const char* name, int n, F f, G g, int /*grain*/ = 0) {
        const DeviceMemory::Open open;
        ++traffic().launches;
        host_.sum_then(name, n, f, g);
    }
    using Recording = ShuffledExec::Recording;
    template <class F>
    void record(Recording& to, int longest, F f) {
        host_.record(to, longest, f);
    }
    void replay(Recording& from) { host_.replay(from); }
    template <class F, class G>
    void min_then(const char* name, int n, F f, G g) {
        const DeviceMemory::Open open;
        ++traffic().launches;
        host_.min_then(name, n, f, g);
    }
    void scan_then(const char* name,
                   View<const int> counts,
                   View<int> offsets,
                   double* total) {
        const DeviceMemory::Open open;
        ++traffic().launches;
        host_.scan_then(name, counts, offsets, total);
    }
    template <class Key>
    void sort_by_key(const char* name, View<Key> keys, View<int> values) {
        const DeviceMemory::Open open;
        ++traffic().launches;
        host_.sort_by_key(name, keys, values);
    }
    template <class T>
    void upload(const std::vector<T>& from, ClosedBuffer<T>& to) {
        to.resize(static_cast<int>(from.size()));
        if (from.empty()) return;
        traffic().add(sizeof(T) * from.size());
        const DeviceMemory::Open open;
        std::copy(from.begin(), from.end(), to.view().begin());
    }
    template <class T>
    void download(View<const T> from, std::vector<T>& to) {
        traffic().add(sizeof(T) * static_cast<std::size_t>(from.size));
        const DeviceMemory::Open open;
        host_.download(from, to);
    }
    template <class T>
    using Arrival = HostArrival<T>;
    template <class T>
    void start_download(View<const T> from, Arrival<T>& to) {
        traffic().arriving += static_cast<long>(sizeof(T)) * from.size;
        const DeviceMemory::Open open;
        to.start(from);
    }
    template <class T>
    void copy(View<const T> from, View<T> to) {
        const DeviceMemory::Open open;
        host_.copy(from, to);
    }
    template <class T>
    T read(View<const T> from, int i) {
        traffic().add(sizeof(T));
        const DeviceMemory::Open open;
        return from[i];
    }

  private:
    // Kernels run in a scrambled order: results must not depend on it.
    ShuffledExec host_;
};

}  // namespace noli::test
