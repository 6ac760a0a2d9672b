!> Bodies whose motions follow from those of another body, by the rows between both: knots of frames and shells, ties, welds.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The rows R_b m_b + R_k m_k = 0 between two bodies give m_b = T m_k where R_b has full column rank: with R_b P = Q [U; 0] and
!! Q'R_k = [S; W] it is T = -P inv(U) S, and W m_k = 0 is what is left. This is elimination in blocks, exact whether the joint is
!! rigid or not. In other rows k takes the place of b, so that these never grow longer, unlike in a sparse factor. A frame of n
!! bars comes down to one body in the time of its rows.
!! Reference: R. E. Tarjan, Efficiency of a good but not linear set union algorithm, J. ACM 22 (1975).
module amontons_joined_bodies
  use amontons_kinds, only: DP
  use amontons_containers, only: list_groups, sort_integers, find_root
  use amontons_blas_lapack, only: dgeqp3, dormqr, dtrsm
  implicit none
  private
  public :: joined_bodies_type, join_bodies, join_vectors

  integer, parameter :: MAX_MOTIONS = 7            !< of a body: a knot has displacements, rotations and a stretch
  real(DP), parameter :: MIN_DIAGONAL = 1.0e-3_DP   !< of U over the largest [-]: bars up to some hundred times as long as thick
  real(DP), parameter :: JOINT_ROUNDING = 1.0e-9_DP   !< of a value of a row on roots over the largest of its terms [-]

  !> The trees of bodies. The motions of a body are T times those of its parent.
  type :: joined_bodies_type
    integer, allocatable :: n(:)                   !< (n_bodies) motions of each body
    integer, allocatable :: body(:), motion(:)     !< (columns) the body, and the number among its motions
    integer, allocatable :: parent(:)              !< (n_bodies) a root is its own parent
    integer, allocatable :: n_below(:)             !< (n_bodies) bodies of the tree of a root
    real(DP), allocatable :: T(:, :, :)            !< (MAX_MOTIONS, MAX_MOTIONS, n_bodies)
    integer, allocatable :: first_of_root(:)       !< (n_bodies + 1) columns of each root in the joined rows
  end type joined_bodies_type

  !> Rows of bodies, one after the other.
  type :: block_rows_type
    integer, allocatable :: first(:)               !< (n_rows + 1)
    integer, allocatable :: body(:)                !< (n_entries)
    real(DP), allocatable :: value(:, :)           !< (MAX_MOTIONS, n_entries)
    logical, allocatable :: is_used(:)             !< (n_rows) spent in a joint
    integer :: n_left = 0                          !< rows W of joints
    integer, allocatable :: left_body(:)           !< (capacity) of each
    real(DP), allocatable :: left_value(:, :)      !< (MAX_MOTIONS, capacity)
  end type block_rows_type

  !> A row on the roots.
  type :: root_row_type
    real(DP), allocatable :: value(:, :)           !< (MAX_MOTIONS, n_bodies) 0 but for the roots found
    integer, allocatable :: root(:)                !< (n_bodies) the first n are set
    integer :: n = 0
  end type root_row_type

contains

  !> Joins bodies as far as rows between two of them allow, and writes the rows that are left on the motions of the roots.
  subroutine join_bodies(n_motions, first, column, value, joined)
    integer, intent(in) :: n_motions(:)            !< (n_bodies) of each body, 0 to 6
    integer, allocatable, intent(inout) :: first(:)   !< (n_rows + 1) start of each row
    integer, allocatable, intent(inout) :: column(:)  !< (n_entries) motions, body by body
    real(DP), allocatable, intent(inout) :: value(:)  !< (n_entries)
    type(joined_bodies_type), intent(out) :: joined
    type(block_rows_type) :: rows
    type(root_row_type) :: row
    integer :: b, n
    call number_motions(n_motions, first, column, joined)
    n = size(joined%n)
    allocate (joined%n_below(n), joined%T(MAX_MOTIONS, MAX_MOTIONS, n))
    joined%parent = [(b, b=1, n)]
    joined%n_below = 1
    allocate (row%value(MAX_MOTIONS, n), source=0.0_DP)
    allocate (row%root(n))
    call list_blocks(joined, first, column, value, rows)
    do while (joins_a_pair(joined, rows, row))
    end do
    call write_rows(joined, rows, row, first, column, value)
  end subroutine join_bodies


  !> Numbers the motions by bodies. Nodes without elements in one row, as the displacements, rotations and the stretch of a knot
  !! are, become one body.
  subroutine number_motions(n_motions, first, column, joined)
    integer, intent(in) :: n_motions(:), first(:), column(:)
    type(joined_bodies_type), intent(inout) :: joined
    integer, parameter :: MAX_OF_NODE = 3
    integer :: owner(sum(n_motions)), parent(size(n_motions)), n(size(n_motions)), new(size(n_motions)), b, c, r, i, node
    c = 0
    do b = 1, size(n_motions)
      owner(c + 1:c + n_motions(b)) = b
      c = c + n_motions(b)
    end do
    parent = [(b, b=1, size(n_motions))]
    n = n_motions
    do r = 1, size(first) - 1
      node = 0
      do i = first(r), first(r + 1) - 1
        if (n_motions(owner(column(i))) > MAX_OF_NODE) cycle
        b = find_root(parent, owner(column(i)))
        if (node == 0) node = b
        if (b == node .or. n(b) + n(node) > MAX_MOTIONS) cycle
        parent(b) = node
        n(node) = n(node) + n(b)
      end do
    end do
    c = 0
    do b = 1, size(n_motions)
      if (parent(b) /= b) cycle
      c = c + 1
      new(b) = c
    end do
    allocate (joined%n(c), joined%body(size(owner)), joined%motion(size(owner)))
    joined%n = 0
    do c = 1, size(owner)
      b = new(find_root(parent, owner(c)))
      joined%n(b) = joined%n(b) + 1
      joined%body(c) = b
      joined%motion(c) = joined%n(b)
    end do
  end subroutine number_motions


  !> The values of all bodies from those of the roots.
  subroutine join_vectors(joined, of_roots, vectors)
    type(joined_bodies_type), intent(inout) :: joined
    real(DP), intent(in) :: of_roots(:, :)         !< (motions of the roots, n)
    real(DP), intent(out) :: vectors(:, :)         !< (motions of all bodies, n)
    integer :: c, b, root, k, m, v
    do c = 1, size(joined%body)
      b = joined%body(c)
      root = root_of(joined, b)
      k = joined%first_of_root(root)
      m = joined%n(root)
      do v = 1, size(vectors, 2)
        if (root == b) vectors(c, v) = of_roots(k + joined%motion(c) - 1, v)
        if (root /= b) vectors(c, v) = dot_product(joined%T(joined%motion(c), :m, b), of_roots(k:k + m - 1, v))
      end do
    end do
  end subroutine join_vectors


  !> The rows by bodies.
  pure subroutine list_blocks(joined, first, column, value, rows)
    type(joined_bodies_type), intent(in) :: joined
    integer, intent(in) :: first(:), column(:)
    real(DP), intent(in) :: value(:)
    type(block_rows_type), intent(out) :: rows
    integer :: place(size(joined%n)), r, i, b, n
    allocate (rows%first(size(first)), rows%body(size(column)))
    allocate (rows%value(MAX_MOTIONS, size(column)), source=0.0_DP)
    allocate (rows%is_used(size(first) - 1), source=.false.)
    allocate (rows%left_body(8), rows%left_value(MAX_MOTIONS, 8))
    place = 0
    n = 0
    do r = 1, size(first) - 1
      rows%first(r) = n + 1
      do i = first(r), first(r + 1) - 1
        b = joined%body(column(i))
        if (place(b) < rows%first(r)) then
          n = n + 1
          place(b) = n
          rows%body(n) = b
        end if
        rows%value(joined%motion(column(i)), place(b)) = value(i)
      end do
    end do
    rows%first(size(first)) = n + 1
  end subroutine list_blocks


  !> The root of a body. Makes it the parent, and T the way to it.
  recursive function root_of(joined, b) result(root)
    type(joined_bodies_type), intent(inout) :: joined
    integer, intent(in) :: b
    integer :: root, p, n, m, k
    p = joined%parent(b)
    root = p
    if (p == b) return
    root = root_of(joined, p)
    if (root == p) return
    n = joined%n(b)
    m = joined%n(p)
    k = joined%n(root)
    joined%T(:n, :k, b) = matmul(joined%T(:n, :m, b), joined%T(:m, :k, p))
    joined%parent(b) = root
  end function root_of


  !> A row of bodies on the present roots.
  subroutine put_on_roots(joined, rows, r, row)
    type(joined_bodies_type), intent(inout) :: joined
    type(block_rows_type), intent(in) :: rows
    integer, intent(in) :: r
    type(root_row_type), intent(inout) :: row      !< its values are 0 on entry
    associate (a => rows%first(r), b => rows%first(r + 1) - 1)
      call add_to_row(joined, rows%body(a:b), rows%value(:, a:b), row)
    end associate
  end subroutine put_on_roots


  !> Values of bodies on the present roots; those that are rounding become zero, and roots without others leave.
  subroutine add_to_row(joined, body, value, row)
    type(joined_bodies_type), intent(inout) :: joined
    integer, intent(in) :: body(:)                 !< (n)
    real(DP), intent(in) :: value(:, :)            !< (MAX_MOTIONS, n)
    type(root_row_type), intent(inout) :: row      !< its values are 0 on entry
    real(DP) :: term(MAX_MOTIONS), largest
    integer :: i, b, root, n, m
    row%n = 0
    largest = 0.0_DP
    do i = 1, size(body)
      b = body(i)
      root = root_of(joined, b)
      n = joined%n(b)
      m = joined%n(root)
      term(:m) = value(:m, i)
      if (root /= b) term(:m) = matmul(value(:n, i), joined%T(:n, :m, b))
      largest = max(largest, maxval(abs(term(:m))))
      if (all(abs(row%value(:, root)) <= 0.0_DP)) then
        row%n = row%n + 1
        row%root(row%n) = root
      end if
      row%value(:m, root) = row%value(:m, root) + term(:m)
    end do
    n = 0
    do i = 1, row%n
      root = row%root(i)
      where (abs(row%value(:, root)) <= JOINT_ROUNDING * largest) row%value(:, root) = 0.0_DP
      if (all(abs(row%value(:, root)) <= 0.0_DP) .or. any(row%root(:n) == root)) cycle
      n = n + 1
      row%root(n) = root
    end do
    row%n = n
  end subroutine add_to_row


  !> Empties a row.
  pure subroutine clear(row)
    type(root_row_type), intent(inout) :: row
    row%value(:, row%root(:row%n)) = 0.0_DP
    row%n = 0
  end subroutine clear


  !> Goes once through all rows on two roots; whether it joined any.
  logical function joins_a_pair(joined, rows, row)
    type(joined_bodies_type), intent(inout) :: joined
    type(block_rows_type), intent(inout) :: rows
    type(root_row_type), intent(inout) :: row      !< work
    integer, allocatable :: first(:), members(:), other(:)
    integer :: low(size(rows%is_used)), high(size(rows%is_used)), r, b, i, j
    low = 0
    high = 0
    do r = 1, size(low)
      if (rows%is_used(r) .or. rows%first(r + 1) == rows%first(r) + 1) cycle
      call put_on_roots(joined, rows, r, row)
      if (row%n == 2) low(r) = minval(row%root(:2))
      if (row%n == 2) high(r) = maxval(row%root(:2))
      call clear(row)
    end do
    call list_groups(low, size(joined%parent), first, members)
    joins_a_pair = .false.
    do b = 1, size(joined%parent)
      if (first(b + 1) == first(b)) cycle
      associate (of_body => members(first(b):first(b + 1) - 1))
        other = high(of_body)
        call sort_integers(other, of_body)
        i = 1
        do while (i <= size(other))
          j = i
          do while (j < size(other))
            if (other(j + 1) /= other(i)) exit
            j = j + 1
          end do
          if (is_joined(joined, rows, of_body(i:j), b, other(i), row)) joins_a_pair = .true.
          i = j + 1
        end do
      end associate
    end do
  end function joins_a_pair


  !> Joins the roots of two bodies if the rows between them allow it.
  logical function is_joined(joined, rows, pair_rows, one, another, row)
    type(joined_bodies_type), intent(inout) :: joined
    type(block_rows_type), intent(inout) :: rows
    integer, intent(in) :: pair_rows(:)            !< that were on two roots: these bodies
    integer, intent(in) :: one, another
    type(root_row_type), intent(inout) :: row      !< work
    real(DP) :: a(size(pair_rows), MAX_MOTIONS, 2)
    integer :: root(2), n(2), i, k
    is_joined = .false.
    root = [root_of(joined, one), root_of(joined, another)]
    if (root(1) == root(2)) return
    if (joined%n_below(root(1)) > joined%n_below(root(2))) root = root([2, 1])   ! the smaller tree is eliminated
    n = joined%n(root)
    do i = 1, size(pair_rows)
      call put_on_roots(joined, rows, pair_rows(i), row)
      do k = 1, 2
        a(i, :, k) = row%value(:, root(k))
      end do
      call clear(row)
    end do
    do k = 1, 2
      is_joined = is_eliminated(a(:, :n(k), k), a(:, :n(3 - k), 3 - k), root(k), root(3 - k), joined, rows)
      if (is_joined) rows%is_used(pair_rows) = .true.
      if (is_joined) return
    end do
  end function is_joined


  !> Eliminates a root in favour of another one if its part of the rows has full rank.
  logical function is_eliminated(a, c, b, k, joined, rows)
    real(DP), intent(in) :: a(:, :)                !< R_b (rows, motions of b)
    real(DP), intent(in) :: c(:, :)                !< R_k (rows, motions of k)
    integer, intent(in) :: b, k                    !< the root that is eliminated, and its new parent
    type(joined_bodies_type), intent(inout) :: joined
    type(block_rows_type), intent(inout) :: rows
    real(DP) :: U(size(a, 1), size(a, 2)), SW(size(c, 1), size(c, 2)), tau(MAX_MOTIONS), work(64), largest
    integer :: order(size(a, 2)), m, n, i, info
    m = size(a, 1)
    n = size(a, 2)
    is_eliminated = .false.
    if (m < n .or. n == 0 .or. size(c, 2) == 0) return
    U = a
    SW = c
    order = 0
    call dgeqp3(m, n, U, m, order, tau, work, size(work), info)
    if (info /= 0 .or. abs(U(n, n)) <= MIN_DIAGONAL * abs(U(1, 1))) return
    call dormqr('L', 'T', m, size(c, 2), n, U, m, tau, SW, m, work, size(work), info)
    if (info /= 0) return
    largest = maxval(abs(c))
    call dtrsm('L', 'U', 'N', 'N', n, size(c, 2), -1.0_DP, U, m, SW, m)
    joined%T(order, :size(c, 2), b) = SW(:n, :)
    joined%parent(b) = k
    joined%n_below(k) = joined%n_below(k) + joined%n_below(b)
    do i = n + 1, m
      if (maxval(abs(SW(i, :))) > JOINT_ROUNDING * largest) call add_left_row(SW(i, :), k, rows)
    end do
    is_eliminated = .true.
  end function is_eliminated


  !> Adds a row W.
  subroutine add_left_row(value, body, rows)
    real(DP), intent(in) :: value(:)
    integer, intent(in) :: body
    type(block_rows_type), intent(inout) :: rows
    real(DP), allocatable :: larger(:, :)
    integer :: n
    n = rows%n_left
    if (n == size(rows%left_body)) then
      rows%left_body = [rows%left_body, rows%left_body]
      allocate (larger(MAX_MOTIONS, 2 * n))
      larger(:, :n) = rows%left_value
      call move_alloc(larger, rows%left_value)
    end if
    rows%n_left = n + 1
    rows%left_body(n + 1) = body
    rows%left_value(:, n + 1) = 0.0_DP
    rows%left_value(:size(value), n + 1) = value
  end subroutine add_left_row


  !> The rows that are left on the motions of the roots.
  subroutine write_rows(joined, rows, row, first, column, value)
    type(joined_bodies_type), intent(inout) :: joined
    type(block_rows_type), intent(in) :: rows
    type(root_row_type), intent(inout) :: row      !< work
    integer, allocatable, intent(inout) :: first(:), column(:)
    real(DP), allocatable, intent(inout) :: value(:)
    integer :: b, r, n, n_rows
    allocate (joined%first_of_root(size(joined%parent) + 1))
    joined%first_of_root(1) = 1
    do b = 1, size(joined%parent)
      n = merge(joined%n(b), 0, joined%parent(b) == b)
      joined%first_of_root(b + 1) = joined%first_of_root(b) + n
    end do
    n_rows = size(rows%is_used)
    deallocate (first, column, value)
    allocate (first(n_rows + rows%n_left + 1), column(MAX_MOTIONS * (size(rows%body) + rows%n_left)), &
      value(MAX_MOTIONS * (size(rows%body) + rows%n_left)))
    n = 0
    do r = 1, n_rows
      first(r) = n + 1
      if (rows%is_used(r)) cycle
      call put_on_roots(joined, rows, r, row)
      call write_row()
    end do
    do r = 1, rows%n_left
      first(n_rows + r) = n + 1
      call add_to_row(joined, rows%left_body(r:r), rows%left_value(:, r:r), row)
      call write_row()
    end do
    first(n_rows + rows%n_left + 1) = n + 1
    column = column(:n)
    value = value(:n)

  contains

    !> Appends the values of the present row that are not 0, and empties it.
    subroutine write_row()
      integer :: i, l
      do i = 1, row%n
        associate (root => row%root(i))
          do l = 1, MAX_MOTIONS
            if (abs(row%value(l, root)) <= 0.0_DP) cycle
            n = n + 1
            column(n) = joined%first_of_root(root) + l - 1
            value(n) = row%value(l, root)
          end do
        end associate
      end do
      call clear(row)
    end subroutine write_row

  end subroutine write_rows

end module amontons_joined_bodies
