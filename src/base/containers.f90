!> Hash table of names, table of labels, growing list of integers, members of groups, disjoint sets, and orders.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_containers
  use amontons_kinds, only: DP, NAME_LENGTH, I64
  use amontons_text, only: name_key
  implicit none
  private
  public :: name_table_type, label_table_type, integer_list_type, list_groups, owners_of_entries, sort_ascending, sort_integers, &
    ascending_order, find_root, unite_trees, edit_distance

  integer, parameter :: KEY_LENGTH = 2 * NAME_LENGTH + 1   !< the name of an instance, a point, the name of a set

  !> Names numbered 1, 2, ... in the order of insertion; case, blanks and quotation marks are ignored.
  type :: name_table_type
    integer :: n = 0                                       !< number of names
    character(KEY_LENGTH), allocatable, private :: keys(:)
    integer, allocatable, private :: slots(:)              !< open addressing: index of a name, 0 free
  contains
    procedure :: add => add_name
    procedure :: find => find_name
    procedure :: nearest => nearest_name
    procedure :: suggest => suggest_names
    procedure, private :: find_slot
    procedure, private :: double_slots
  end type name_table_type

  !> Maps labels (positive numbers of the user) to indices 1 to n: a direct table for dense labels, else a sorted list.
  type :: label_table_type
    integer, private :: low = 1                            !< label of direct(1)
    integer, allocatable, private :: direct(:)             !< index of label low + i - 1; 0: no such label
    integer, allocatable, private :: sorted(:)             !< labels ascending
    integer, allocatable, private :: position(:)           !< their indices
  contains
    procedure :: build => build_labels
    procedure :: find => find_label
  end type label_table_type

  !> A list of integers that grows: amortised constant cost per item.
  type :: integer_list_type
    integer :: n = 0
    integer, allocatable :: items(:)                       !< the first n count
  contains
    procedure :: add => add_integer
    procedure :: trimmed => trimmed_integers
  end type integer_list_type

contains

  !> Adds a name or finds it.
  subroutine add_name(self, name, position, is_new)
    class(name_table_type), intent(inout) :: self
    character(*), intent(in) :: name             !< at most KEY_LENGTH characters count
    integer, intent(out) :: position             !< its number
    logical, intent(out) :: is_new
    character(KEY_LENGTH), allocatable :: larger(:)
    character(KEY_LENGTH) :: key
    integer :: slot
    if (.not. allocated(self%slots)) then
      allocate (self%slots(64), source=0)
      allocate (self%keys(32))
    end if
    key = name_key(name)
    slot = self%find_slot(key)
    position = self%slots(slot)
    is_new = position == 0
    if (.not. is_new) return
    if (self%n == size(self%keys)) then
      allocate (larger(2 * self%n))
      larger(:self%n) = self%keys
      call move_alloc(larger, self%keys)
    end if
    self%n = self%n + 1
    position = self%n
    self%keys(position) = key
    self%slots(slot) = position
    if (2 * self%n > size(self%slots)) call self%double_slots()
  end subroutine add_name


  !> The number of a name; 0 if the table does not contain it.
  pure function find_name(self, name) result(position)
    class(name_table_type), intent(in) :: self
    character(*), intent(in) :: name
    integer :: position
    character(KEY_LENGTH) :: key
    position = 0
    if (.not. allocated(self%slots)) return
    key = name_key(name)
    position = self%slots(self%find_slot(key))
  end function find_name


  !> The position of the known name nearest to an unknown one; 0: no name is near.
  pure integer function nearest_name(self, name) result(best)
    class(name_table_type), intent(in) :: self
    character(*), intent(in) :: name
    character(:), allocatable :: word
    integer :: i, least, distance
    best = 0
    word = name_key(name)
    if (word == '') return
    least = 1 + max(1, len_trim(word) / 3)
    do i = 1, self%n
      distance = edit_distance(trim(word), trim(self%keys(i)))
      if (distance >= least) cycle
      least = distance
      best = i
    end do
  end function nearest_name


  !> The end of a sentence about an unknown name: the nearest name, all names if there are few, or a full stop.
  function suggest_names(self, name) result(text)
    class(name_table_type), intent(in) :: self
    character(*), intent(in) :: name
    character(:), allocatable :: text
    integer, parameter :: MAX_LISTED_NAMES = 5
    integer :: i, best
    text = '.'
    if (name_key(name) == '') return
    best = self%nearest(name)
    if (best > 0) then
      text = '; did you mean ' // trim(self%keys(best)) // '?'
    else if (self%n == 0) then
      text = '; the deck has none at all.'
    else if (self%n == 1) then
      text = '; there is only ' // trim(self%keys(1)) // '.'
    else if (self%n <= MAX_LISTED_NAMES) then
      text = '; there are ' // trim(self%keys(1))
      do i = 2, self%n
        if (i < self%n) text = text // ', ' // trim(self%keys(i))
        if (i == self%n) text = text // ' and ' // trim(self%keys(i)) // '.'
      end do
    end if
  end function suggest_names


  !> Edit distance of two words: letters to change, insert, delete or exchange with their neighbour
  !! (optimal string alignment).
  pure integer function edit_distance(one, other) result(distance)
    character(*), intent(in) :: one, other
    integer :: rows(0:len(other), 0:2)             ! of the last row but one, the last one, and this one
    integer :: i, j, change
    rows(:, 2) = [(j, j=0, len(other))]
    do i = 1, len(one)
      rows(:, 0) = rows(:, 1)
      rows(:, 1) = rows(:, 2)
      rows(0, 2) = i
      do j = 1, len(other)
        change = merge(0, 1, one(i:i) == other(j:j))
        rows(j, 2) = min(rows(j, 1) + 1, rows(j - 1, 2) + 1, rows(j - 1, 1) + change)
        if (i == 1 .or. j == 1) cycle
        if (one(i:i) == other(j - 1:j - 1) .and. one(i - 1:i - 1) == other(j:j)) &
          rows(j, 2) = min(rows(j, 2), rows(max(j - 2, 0), 0) + 1)
      end do
    end do
    distance = rows(len(other), 2)
  end function edit_distance


  !> The slot of a key, or the free slot for it (FNV-1a hash, linear probing).
  pure function find_slot(self, key) result(slot)
    class(name_table_type), intent(in) :: self
    character(KEY_LENGTH), intent(in) :: key
    integer :: slot, i
    integer(I64) :: hash
    hash = 2166136261_I64
    do i = 1, len_trim(key)
      hash = iand(ieor(hash, int(iachar(key(i:i)), I64)) * 16777619_I64, 4294967295_I64)
    end do
    slot = 1 + int(modulo(hash, int(size(self%slots), I64)))
    do while (self%slots(slot) /= 0)
      if (self%keys(self%slots(slot)) == key) return
      slot = 1 + modulo(slot, size(self%slots))
    end do
  end function find_slot


  !> Doubles the number of slots.
  subroutine double_slots(self)
    class(name_table_type), intent(inout) :: self
    integer :: i, n_slots
    n_slots = 2 * size(self%slots)
    deallocate (self%slots)
    allocate (self%slots(n_slots), source=0)
    do i = 1, self%n
      self%slots(self%find_slot(self%keys(i))) = i
    end do
  end subroutine double_slots


  !> Builds the table. A repeated label keeps its first index.
  subroutine build_labels(self, labels)
    class(label_table_type), intent(out) :: self
    integer, intent(in) :: labels(:)             !< (n) all positive
    integer :: i, n
    integer(I64) :: span
    n = size(labels)
    if (n == 0) return
    self%low = minval(labels)
    span = int(maxval(labels), I64) - int(self%low, I64) + 1_I64
    if (span <= 8 * int(n, I64) + 1000_I64) then
      allocate (self%direct(span), source=0)
      do i = n, 1, -1
        self%direct(labels(i) - self%low + 1) = i
      end do
    else
      allocate (self%position(n))
      self%position = [(i, i=1, n)]
      self%sorted = labels
      call sort_integers(self%sorted, self%position)
    end if
  end subroutine build_labels


  !> The index of a label; 0 if the table does not contain it.
  pure function find_label(self, label) result(position)
    class(label_table_type), intent(in) :: self
    integer, intent(in) :: label
    integer :: position, low, high, middle
    position = 0
    if (allocated(self%direct)) then
      if (label < self%low) return
      if (label - self%low >= size(self%direct)) return
      position = self%direct(label - self%low + 1)
    else if (allocated(self%sorted)) then
      low = 1
      high = size(self%sorted)
      do while (low < high)
        middle = low + (high - low) / 2
        if (self%sorted(middle) < label) then
          low = middle + 1
        else
          high = middle
        end if
      end do
      if (self%sorted(low) == label) position = self%position(low)
    end if
  end function find_label


  !> Appends one integer.
  subroutine add_integer(self, value)
    class(integer_list_type), intent(inout) :: self
    integer, intent(in) :: value
    integer, allocatable :: larger(:)
    if (.not. allocated(self%items)) allocate (self%items(64))
    if (self%n == size(self%items)) then
      allocate (larger(2 * self%n))
      larger(:self%n) = self%items
      call move_alloc(larger, self%items)
    end if
    self%n = self%n + 1
    self%items(self%n) = value
  end subroutine add_integer


  !> The items as an array of exact size.
  pure function trimmed_integers(self) result(items)
    class(integer_list_type), intent(in) :: self
    integer, allocatable :: items(:)
    if (self%n == 0) then
      allocate (items(0))
    else
      items = self%items(:self%n)
    end if
  end function trimmed_integers


  !> The members of each group, ascending: those of group g are members(first(g):first(g + 1) - 1). Cost: linear.
  pure subroutine list_groups(group, n_groups, first, members)
    integer, intent(in) :: group(:)                        !< (n) group of each member, 1 to n_groups; 0: in no group
    integer, intent(in) :: n_groups
    integer, allocatable, intent(out) :: first(:)          !< (n_groups + 1)
    integer, allocatable, intent(out) :: members(:)
    integer, allocatable :: next(:)
    integer :: k
    allocate (first(n_groups + 1), members(count(group > 0)))
    first = 0
    do k = 1, size(group)
      first(group(k) + 1) = first(group(k) + 1) + 1
    end do
    first(1) = 1
    do k = 1, n_groups
      first(k + 1) = first(k) + first(k + 1)
    end do
    next = first(:n_groups)
    do k = 1, size(group)
      if (group(k) == 0) cycle
      members(next(group(k))) = k
      next(group(k)) = next(group(k)) + 1
    end do
  end subroutine list_groups


  !> The list to which each entry of compressed lists belongs: entries first(k) to first(k + 1) - 1 are those of list k.
  pure function owners_of_entries(first) result(owner)
    integer, intent(in) :: first(:)                        !< (lists + 1), the first 1
    integer, allocatable :: owner(:)                       !< (entries)
    integer :: k
    allocate (owner(first(size(first)) - 1))
    do k = 1, size(first) - 1
      owner(first(k):first(k + 1) - 1) = k
    end do
  end function owners_of_entries


  !> Sorts a short list in place by insertion.
  pure subroutine sort_ascending(list)
    integer, intent(inout) :: list(:)                  !< (n)
    integer :: i, k, item
    do i = 2, size(list)
      item = list(i)
      k = i
      do while (k > 1)
        if (list(k - 1) <= item) exit
        list(k) = list(k - 1)
        k = k - 1
      end do
      list(k) = item
    end do
  end subroutine sort_ascending


  !> Sorts integers in place, stable; a second array is permuted with the keys. Cost: n log n.
  pure subroutine sort_integers(keys, companion)
    integer, intent(inout) :: keys(:)                  !< (n)
    integer, intent(inout), optional :: companion(:)   !< (n) moved as the keys are
    integer, allocatable :: order(:)
    if (size(keys) < 2) return
    if (all(keys(2:) >= keys(:size(keys) - 1))) return
    order = ascending_order(real(keys, DP))
    keys = keys(order)
    if (present(companion)) companion = companion(order)
  end subroutine sort_integers


  !> The order in which keys ascend; equal keys keep their order. Bottom-up merge sort. Cost: n log n.
  pure function ascending_order(keys) result(order)
    real(DP), intent(in) :: keys(:)                    !< (n)
    integer, allocatable :: order(:)                   !< (n)
    integer, allocatable :: other(:)
    integer :: n, width, first, i
    n = size(keys)
    order = [(i, i=1, n)]
    allocate (other(n))
    width = 1
    do while (width < n)
      do first = 1, n, 2 * width
        call merge_runs(keys, order, other, first, min(first + width, n + 1), min(first + 2 * width, n + 1))
        if (first > n - 2 * width) exit
      end do
      call swap(order, other)
      if (width > n / 2) exit
      width = 2 * width
    end do
  end function ascending_order


  !> Merges from(first:middle-1) and from(middle:end-1), both ordered by key, into to(first:end-1).
  pure subroutine merge_runs(keys, from, to, first, middle, end)
    real(DP), intent(in) :: keys(:)
    integer, intent(in) :: from(:)
    integer, intent(inout) :: to(:)
    integer, intent(in) :: first, middle, end
    integer :: i, j, k
    i = first
    j = middle
    do k = first, end - 1
      if (i < middle .and. (j >= end)) then
        to(k) = from(i)
        i = i + 1
      else if (i >= middle) then
        to(k) = from(j)
        j = j + 1
      else if (keys(from(i)) <= keys(from(j))) then
        to(k) = from(i)
        i = i + 1
      else
        to(k) = from(j)
        j = j + 1
      end if
    end do
  end subroutine merge_runs


  !> Root of a node in a forest of disjoint sets (union-find), with path halving.
  integer function find_root(parent, node) result(root)
    integer, intent(inout) :: parent(:)                !< of each node; a root is its own parent
    integer, intent(in) :: node
    root = node
    do while (parent(root) /= root)
      parent(root) = parent(parent(root))
      root = parent(root)
    end do
  end function find_root


  !> Unites the trees of two nodes; the smaller number is the root.
  subroutine unite_trees(parent, a, b)
    integer, intent(inout) :: parent(:)
    integer, intent(in) :: a, b
    integer :: root_a, root_b
    root_a = find_root(parent, a)
    root_b = find_root(parent, b)
    parent(max(root_a, root_b)) = min(root_a, root_b)
  end subroutine unite_trees


  !> Exchanges two arrays without copying.
  pure subroutine swap(a, b)
    integer, allocatable, intent(inout) :: a(:), b(:)
    integer, allocatable :: c(:)
    call move_alloc(a, c)
    call move_alloc(b, a)
    call move_alloc(c, b)
  end subroutine swap

end module amontons_containers
