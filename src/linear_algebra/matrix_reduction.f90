!> Reduction A = C' K C of a symmetric matrix K to the free unknowns: the pattern of A once, its values for each K.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! C has a row for each unknown of K: empty for a fixed one, one entry for a free one, several for a dependent one. Matrices are
!! those of amontons_sparse, symmetric ones by their upper triangle. Every sum has a fixed order: results repeat bitwise, with any
!! number of threads.
module amontons_matrix_reduction
  use amontons_kinds, only: DP, I64
  use amontons_errors, only: error_type, set_error, EXIT_INTERNAL
  use amontons_containers, only: sort_integers
  use amontons_sparse, only: sparse_type, sparse_transpose, alike_rows, entry_position, set_too_large
  implicit none
  private
  public :: reduction_type, analyse_reduction, reduce_matrix

  integer, parameter :: ROWS_PER_BLOCK = 16384          !< rows of a pattern that a thread lists at a time

  !> Plan of the summation A = C' K C: built once for a pattern of K and C, used for all values of them.
  !> Most unknowns are direct: their row of C has one entry, and the columns of these entries ascend. Their entries of K are found
  !> in A by walking along both rows. The other entries are expanded, row by row: with s = sum K_ij C_j over those of row i, half of
  !! K_ii, A = A + C_i' s + s' C_i. The columns of s are far fewer than the entries of all C_j.
  type :: reduction_type
    private
    integer :: n_entries_k = 0                 !< of K, to recognise a wrong matrix
    integer :: n_entries_c = 0                 !< of C
    integer, allocatable :: direct(:)          !< (n_rows) row of A of a direct unknown, else 0; IDLE: without stiffness, not direct
    integer, allocatable :: row(:)             !< rows of K that have expanded entries
    integer, allocatable :: row_first(:)       !< (size(row) + 1) start of a row's entries in entry(:)
    integer, allocatable :: entry(:)           !< expanded entries of K
    integer, allocatable :: width(:)           !< (size(row)) columns of s
    integer, allocatable :: slot(:)            !< column of s for each entry of C_j, for each expanded entry of K
    integer, allocatable :: target(:)          !< entry of A for each entry of C_i with each column of s; negative: counts twice
  end type reduction_type

  integer, parameter :: IDLE = -1

  !> A list of integers that grows.
  type :: growing_list_type
    integer, allocatable :: items(:)
    integer :: n = 0
    integer :: capacity = 0
    logical :: is_full = .false.               !< an item did not fit: default integers cannot count them
  contains
    procedure :: reserve => reserve_items
    procedure :: append => append_item
    procedure :: to_array => list_to_array
  end type growing_list_type

contains

  !> Prepares A = C' K C: the pattern of A and the target of every product. C has a row for each unknown of K: empty for a
  !> fixed one, one entry for a free one, several for a dependent one. Entries of C may be zero: they stay in the pattern of A.
  !> Unknowns without stiffness, as reference nodes have them, add nothing, however many others they depend on.
  !> Cost: a few passes over K and A.
  subroutine analyse_reduction(matrix, transformation, reduction, reduced, error, is_idle)
    type(sparse_type), intent(in) :: matrix    !< K, upper triangle (n x n)
    type(sparse_type), intent(in) :: transformation  !< C (n x m)
    type(reduction_type), intent(out) :: reduction
    type(sparse_type), intent(out) :: reduced  !< A, upper triangle (m x m), diagonal present, without values
    type(error_type), allocatable, intent(out) :: error
    logical, intent(in), optional :: is_idle(:)   !< (n) the row and the column of K are zero always
    integer, allocatable :: general(:)
    if (matrix%n_rows /= transformation%n_rows .or. matrix%n_columns /= matrix%n_rows) then
      call set_error(error, EXIT_INTERNAL, 'Matrix and relation of a reduction do not fit together.')
      return
    end if
    reduction%direct = direct_rows(transformation)
    if (present(is_idle)) where (is_idle .and. reduction%direct == 0) reduction%direct = IDLE
    general = general_rows(matrix, transformation, reduction%direct)
    call reduced_pattern(matrix, general, transformation, reduction%direct, reduced, error)
    if (allocated(error)) return
    reduction%n_entries_k = size(matrix%column)
    reduction%n_entries_c = size(transformation%column)
    call find_pair_targets(matrix, general, transformation, reduced, reduction, error)
  end subroutine analyse_reduction


  !> The pattern of C' K C: row a of A has the columns of row j of C for all j coupled by K with an i that depends on a. The threads
  !! share blocks of rows.
  subroutine reduced_pattern(matrix, general, transformation, direct, reduced, error)
    type(sparse_type), intent(in) :: matrix, transformation
    integer, intent(in) :: general(:)          !< of general_rows
    integer, intent(in) :: direct(:)           !< (n) as in reduction_type
    type(sparse_type), intent(out) :: reduced
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: dependents, mirrored
    type(growing_list_type), allocatable :: blocks(:)   ! columns of A in a block of rows
    integer :: a, k, n
    mirrored = mirror_entries(matrix, general, transformation, direct)
    dependents = sparse_transpose(transformation)
    n = transformation%n_columns
    reduced%n_rows = n
    reduced%n_columns = n
    allocate (reduced%first(n + 1), blocks((n + ROWS_PER_BLOCK - 1) / ROWS_PER_BLOCK))
    !$omp parallel
    call list_columns(matrix, mirrored, dependents, transformation, direct, reduced%first, blocks)
    !$omp end parallel
    if (any(blocks%is_full) .or. sum(int(blocks%n, I64)) >= int(huge(n), I64)) then
      call set_too_large(error)
      return
    end if
    reduced%first(1) = 1
    do a = 1, n
      reduced%first(a + 1) = reduced%first(a) + reduced%first(a + 1)
    end do
    allocate (reduced%column(reduced%first(n + 1) - 1))
    !$omp parallel do schedule(static) private(a)
    do k = 1, size(blocks)
      a = reduced%first((k - 1) * ROWS_PER_BLOCK + 1)
      reduced%column(a:a + blocks(k)%n - 1) = blocks(k)%items(:blocks(k)%n)
      deallocate (blocks(k)%items)
    end do
    !$omp end parallel do
    reduced%n_alike = alike_rows(reduced)
  end subroutine reduced_pattern


  !> One thread's share of the blocks. (A procedure: gfortran 12 frees no allocatable variable of a block within a parallel region.)
  subroutine list_columns(matrix, mirrored, dependents, transformation, direct, n_entries, blocks)
    type(sparse_type), intent(in) :: matrix         !< K
    type(sparse_type), intent(in) :: mirrored       !< its transposed entries
    type(sparse_type), intent(in) :: dependents     !< C'
    type(sparse_type), intent(in) :: transformation !< C
    integer, intent(in) :: direct(:)                !< (n) as in reduction_type
    integer, intent(inout) :: n_entries(:)          !< (n_columns + 1) entries of row a of A behind a; the first is not set
    type(growing_list_type), intent(inout) :: blocks(:)
    integer, allocatable :: seen(:)
    integer :: k, a, d, last, n_before
    allocate (seen(transformation%n_columns), source=0)
    !$omp do schedule(dynamic)
    do k = 1, size(blocks)
      last = min(k * ROWS_PER_BLOCK, transformation%n_columns)
      call blocks(k)%reserve(size(matrix%column) / size(blocks) + ROWS_PER_BLOCK)
      do a = (k - 1) * ROWS_PER_BLOCK + 1, last
        n_before = blocks(k)%n
        seen(a) = a
        call blocks(k)%append(a)
        do d = dependents%first(a), dependents%first(a + 1) - 1
          if (direct(dependents%column(d)) == IDLE) cycle
          call append_columns_above(matrix, dependents%column(d), transformation, a, seen, blocks(k))
          call append_columns_above(mirrored, dependents%column(d), transformation, a, seen, blocks(k))
        end do
        n_entries(a + 1) = blocks(k)%n - n_before
        call sort_integers(blocks(k)%items(n_before + 1:blocks(k)%n))
      end do
    end do
    !$omp end do
  end subroutine list_columns


  !> The row of A of each direct unknown, else 0: C has one entry for it, in a column behind those of the direct unknowns before it.
  !! So entries of K between two of them lie in the upper triangle of A already, in the same order.
  pure function direct_rows(transformation) result(direct)
    type(sparse_type), intent(in) :: transformation
    integer :: direct(transformation%n_rows)
    integer :: i, last
    last = 0
    do i = 1, transformation%n_rows
      direct(i) = 0
      if (transformation%first(i + 1) - transformation%first(i) /= 1) cycle
      if (transformation%column(transformation%first(i)) <= last) cycle
      last = transformation%column(transformation%first(i))
      direct(i) = last
    end do
  end function direct_rows


  !> The rows of K with an entry between two unknowns of A of which one is not direct. The threads share the rows.
  function general_rows(matrix, transformation, direct) result(rows)
    type(sparse_type), intent(in) :: matrix    !< K, upper triangle
    type(sparse_type), intent(in) :: transformation   !< C
    integer, intent(in) :: direct(:)           !< (n) as in reduction_type
    integer, allocatable :: rows(:)            !< ascending
    logical :: is_general(matrix%n_rows)
    integer :: i
    !$omp parallel do schedule(static)
    do i = 1, matrix%n_rows
      is_general(i) = has_general_entry(i)
    end do
    !$omp end parallel do
    rows = pack([(i, i=1, matrix%n_rows)], is_general)

  contains

    !> Whether a row has such an entry.
    pure logical function has_general_entry(row)
      integer, intent(in) :: row
      integer :: p
      has_general_entry = .false.
      do p = matrix%first(row), matrix%first(row + 1) - 1
        has_general_entry = is_general_entry(transformation, direct, row, matrix%column(p))
        if (has_general_entry) return
      end do
    end function has_general_entry

  end function general_rows


  !> Whether entry (i, j) of K is between two unknowns that depend on those of A, of which one is not direct.
  pure logical function is_general_entry(transformation, direct, i, j) result(is_general)
    type(sparse_type), intent(in) :: transformation   !< C
    integer, intent(in) :: direct(:)           !< (n) as in reduction_type
    integer, intent(in) :: i, j
    is_general = direct(i) == 0 .or. direct(j) == 0
    if (is_general) is_general = transformation%first(i + 1) > transformation%first(i) .and. &
      transformation%first(j + 1) > transformation%first(j)
  end function is_general_entry


  !> The transposed entries of K that the upper triangle of A needs: those that touch an unknown which is not direct.
  pure function mirror_entries(matrix, general, transformation, direct) result(mirrored)
    type(sparse_type), intent(in) :: matrix    !< K, upper triangle
    integer, intent(in) :: general(:)          !< of general_rows
    type(sparse_type), intent(in) :: transformation   !< C
    integer, intent(in) :: direct(:)           !< (n) as in reduction_type
    type(sparse_type) :: mirrored              !< pattern only
    integer :: next(matrix%n_rows), i, j, k, p
    mirrored%n_rows = matrix%n_rows
    mirrored%n_columns = matrix%n_rows
    next = 0
    do k = 1, size(general)
      i = general(k)
      do p = matrix%first(i) + 1, matrix%first(i + 1) - 1
        if (is_general_entry(transformation, direct, i, matrix%column(p))) next(matrix%column(p)) = next(matrix%column(p)) + 1
      end do
    end do
    allocate (mirrored%first(matrix%n_rows + 1))
    mirrored%first(1) = 1
    do j = 1, matrix%n_rows
      mirrored%first(j + 1) = mirrored%first(j) + next(j)
    end do
    next = mirrored%first(:matrix%n_rows)
    allocate (mirrored%column(mirrored%first(matrix%n_rows + 1) - 1))
    do k = 1, size(general)
      i = general(k)
      do p = matrix%first(i) + 1, matrix%first(i + 1) - 1
        j = matrix%column(p)
        if (.not. is_general_entry(transformation, direct, i, j)) cycle
        mirrored%column(next(j)) = i
        next(j) = next(j) + 1
      end do
    end do
  end function mirror_entries


  !> Appends the columns of A above the diagonal to which a row of K leads.
  pure subroutine append_columns_above(matrix, row, transformation, a, seen, above)
    type(sparse_type), intent(in) :: matrix    !< K, or its mirrored entries
    integer, intent(in) :: row
    type(sparse_type), intent(in) :: transformation   !< C
    integer, intent(in) :: a                   !< row of A
    integer, intent(inout) :: seen(:)          !< (n_columns) a for those appended already
    type(growing_list_type), intent(inout) :: above
    integer :: p, q
    do p = matrix%first(row), matrix%first(row + 1) - 1
      do q = transformation%first(matrix%column(p)), transformation%first(matrix%column(p) + 1) - 1
        if (transformation%column(q) <= a) cycle
        if (seen(transformation%column(q)) == a) cycle
        seen(transformation%column(q)) = a
        call above%append(transformation%column(q))
      end do
    end do
  end subroutine append_columns_above


  !> Records the positions of the columns of one row.
  pure subroutine mark_row(matrix, row, place)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: row
    integer, intent(inout) :: place(:)         !< (n_columns) entries of other columns are unchanged
    integer :: p
    do p = matrix%first(row), matrix%first(row + 1) - 1
      place(matrix%column(p)) = p
    end do
  end subroutine mark_row


  !> Position of (a, b) or (b, a) in the upper triangle.
  pure integer function find_target(matrix, a, b, place) result(position)
    type(sparse_type), intent(in) :: matrix    !< upper triangle
    integer, intent(in) :: a, b
    integer, intent(in) :: place(:)            !< as mark_row sets it for row a
    if (b >= a) then
      position = place(b)
    else
      position = entry_position(matrix, b, a)
    end if
  end function find_target


  !> The entries of K that touch an unknown which is not direct; for each row the columns of s and their targets in A.
  subroutine find_pair_targets(matrix, general, transformation, reduced, reduction, error)
    type(sparse_type), intent(in) :: matrix, transformation, reduced
    integer, intent(in) :: general(:)          !< of general_rows
    type(reduction_type), intent(inout) :: reduction
    type(error_type), allocatable, intent(out) :: error
    integer :: place(transformation%n_columns), slot_of(transformation%n_columns)
    type(growing_list_type) :: rows, row_first, entries, widths, slots, targets
    integer, allocatable :: columns(:)
    integer :: i, k, p, a, n_before
    place = 0
    slot_of = 0
    do k = 1, size(general)
      i = general(k)
      n_before = entries%n
      do p = matrix%first(i), matrix%first(i + 1) - 1
        associate (j => matrix%column(p))
          if (reduction%direct(i) == IDLE .or. reduction%direct(j) == IDLE) cycle
          if (is_general_entry(transformation, reduction%direct, i, j)) call entries%append(p)
        end associate
      end do
      if (entries%n == n_before) cycle
      call rows%append(i)
      call row_first%append(n_before + 1)
      call find_slots(transformation, matrix%column(entries%items(n_before + 1:entries%n)), slot_of, slots, columns)
      call widths%append(size(columns))
      do a = transformation%first(i), transformation%first(i + 1) - 1
        call mark_row(reduced, transformation%column(a), place)
        call append_targets(reduced, transformation%column(a), columns, place, targets)
      end do
    end do
    call row_first%append(entries%n + 1)
    if (slots%is_full .or. targets%is_full) then
      call set_too_large(error)
      return
    end if
    call rows%to_array(reduction%row)
    call row_first%to_array(reduction%row_first)
    call entries%to_array(reduction%entry)
    call widths%to_array(reduction%width)
    call slots%to_array(reduction%slot)
    call targets%to_array(reduction%target)
  end subroutine find_pair_targets


  !> The columns of some rows of C, each once, and for each entry of these rows the place of its column among them.
  pure subroutine find_slots(transformation, rows, slot_of, slots, columns)
    type(sparse_type), intent(in) :: transformation
    integer, intent(in) :: rows(:)
    integer, intent(inout) :: slot_of(:)       !< (n_columns) 0, in and out
    type(growing_list_type), intent(inout) :: slots
    integer, allocatable, intent(out) :: columns(:)
    integer :: e, b, n
    allocate (columns(sum(transformation%first(rows + 1) - transformation%first(rows))))
    n = 0
    do e = 1, size(rows)
      do b = transformation%first(rows(e)), transformation%first(rows(e) + 1) - 1
        associate (column => transformation%column(b))
          if (slot_of(column) == 0) then
            n = n + 1
            columns(n) = column
            slot_of(column) = n
          end if
          call slots%append(slot_of(column))
        end associate
      end do
    end do
    columns = columns(:n)
    slot_of(columns) = 0
  end subroutine find_slots


  !> The targets of the products of one entry of C with some columns.
  pure subroutine append_targets(reduced, a, columns, place, targets)
    type(sparse_type), intent(in) :: reduced
    integer, intent(in) :: a                   !< column of the entry of C: row of A
    integer, intent(in) :: columns(:)
    integer, intent(in) :: place(:)            !< as mark_row sets it for row a
    type(growing_list_type), intent(inout) :: targets
    integer :: k, target
    do k = 1, size(columns)
      target = find_target(reduced, a, columns(k), place)
      if (columns(k) == a) target = -target
      call targets%append(target)
    end do
  end subroutine append_targets


  !> A = C' K C for new values of K and C in the patterns analysed. Cost: one pass over K, A and the plan. The threads
  !! share the rows of direct unknowns.
  subroutine reduce_matrix(reduction, matrix, transformation, reduced, error)
    type(reduction_type), intent(in) :: reduction
    type(sparse_type), intent(in) :: matrix    !< K, upper triangle (n x n)
    type(sparse_type), intent(in) :: transformation  !< C (n x m)
    type(sparse_type), intent(inout) :: reduced   !< A from analyse_reduction; its values are set
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    if (size(matrix%column) /= reduction%n_entries_k .or. size(transformation%column) /= reduction%n_entries_c) then
      call set_error(error, EXIT_INTERNAL, 'A reduction was used with other patterns than those analysed.')
      return
    end if
    if (.not. allocated(reduced%value)) allocate (reduced%value(size(reduced%column)))
    !$omp parallel
    !$omp do schedule(static)
    do i = 1, reduced%n_rows
      reduced%value(reduced%first(i):reduced%first(i + 1) - 1) = 0.0_DP
    end do
    !$omp end do
    !$omp do schedule(static)
    do i = 1, matrix%n_rows
      if (reduction%direct(i) > 0) call add_direct_row(reduction%direct, matrix, transformation, i, reduced)
    end do
    !$omp end do
    !$omp end parallel
    call add_pairs(reduction, matrix, transformation, reduced%value)
  end subroutine reduce_matrix


  !> Adds the entries of K in the row of a direct unknown and in columns of others to the row of A.
  pure subroutine add_direct_row(direct, matrix, transformation, i, reduced)
    integer, intent(in) :: direct(:)           !< (n) as in reduction_type
    type(sparse_type), intent(in) :: matrix    !< K, upper triangle
    type(sparse_type), intent(in) :: transformation   !< C
    integer, intent(in) :: i
    type(sparse_type), intent(inout) :: reduced   !< A, upper triangle
    real(DP) :: scale
    integer :: p, q
    scale = transformation%value(transformation%first(i))
    q = reduced%first(direct(i))
    do p = matrix%first(i), matrix%first(i + 1) - 1
      associate (j => matrix%column(p))
        if (direct(j) <= 0) cycle
        do while (reduced%column(q) < direct(j))
          q = q + 1
        end do
        reduced%value(q) = reduced%value(q) + scale * matrix%value(p) * transformation%value(transformation%first(j))
      end associate
    end do
  end subroutine add_direct_row


  !> Adds the contributions of expanded entries, in the order of find_pair_targets.
  pure subroutine add_pairs(reduction, matrix, transformation, value)
    type(reduction_type), intent(in) :: reduction
    type(sparse_type), intent(in) :: matrix, transformation
    real(DP), intent(inout) :: value(:)        !< of A
    real(DP) :: s(max(1, maxval(reduction%width))), amount, product
    integer :: r, i, j, a, b, e, k, n_slots, n_targets
    n_slots = 0
    n_targets = 0
    do r = 1, size(reduction%row)
      i = reduction%row(r)
      s(:reduction%width(r)) = 0
      do e = reduction%row_first(r), reduction%row_first(r + 1) - 1
        j = matrix%column(reduction%entry(e))
        amount = matrix%value(reduction%entry(e)) * merge(0.5_DP, 1.0_DP, j == i)
        do b = transformation%first(j), transformation%first(j + 1) - 1
          n_slots = n_slots + 1
          associate (sum => s(reduction%slot(n_slots)))
            sum = sum + amount * transformation%value(b)
          end associate
        end do
      end do
      do a = transformation%first(i), transformation%first(i + 1) - 1
        do k = 1, reduction%width(r)
          n_targets = n_targets + 1
          associate (q => reduction%target(n_targets))
            product = transformation%value(a) * s(k)
            if (q < 0) product = 2 * product
            value(abs(q)) = value(abs(q)) + product
          end associate
        end do
      end do
    end do
  end subroutine add_pairs


  !> Adds an item to the list. Cost: amortised constant. A list that cannot grow sets is_full.
  pure subroutine append_item(self, item)
    class(growing_list_type), intent(inout) :: self
    integer, intent(in) :: item
    integer, allocatable :: larger(:)
    if (self%n == self%capacity) then
      self%is_full = self%capacity == huge(self%n)
      if (self%is_full) return
      self%capacity = max(1024, self%capacity + min(self%capacity, huge(self%n) - self%capacity))
      allocate (larger(self%capacity))
      if (self%n > 0) larger(:self%n) = self%items
      call move_alloc(larger, self%items)
    end if
    self%n = self%n + 1
    self%items(self%n) = item
  end subroutine append_item


  !> Memory for a number of items in an empty list: pages that are not used cost nothing.
  pure subroutine reserve_items(self, n)
    class(growing_list_type), intent(inout) :: self
    integer, intent(in) :: n
    allocate (self%items(n))
    self%capacity = n
  end subroutine reserve_items


  !> The list as an array of exact size.
  pure subroutine list_to_array(self, array)
    class(growing_list_type), intent(in) :: self
    integer, allocatable, intent(out) :: array(:)
    allocate (array(self%n))
    if (self%n > 0) array = self%items(:self%n)
  end subroutine list_to_array

end module amontons_matrix_reduction
