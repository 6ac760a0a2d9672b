!> Condensed: the bulk is factorised with its contact unknowns last, and contact is solved on the small dense interface.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/solver.md, "Contact unknowns last". With the unknowns that contact can reach (c) ordered last, the
!! trailing block of the Cholesky factor of the bulk is the condensed stiffness of the interface,
!!
!!     S = K_cc - K_ci inv(K_ii) K_ic = L_cc L_cc' - D,
!!
!! D being a known diagonal that is added before the factorisation, so that a body held by contact alone does not make it
!! break. Statuses, friction and weights change c only: for each of them the tangent
!!
!!     J_c = C_c' ((1 + D_R) S - D_u) C_c
!!
!! is small, dense, and factorised by LU, while the factor of the bulk stays. With a factor of the present bulk this is
!! the exact inverse of the tangent J; with an older one it is a preconditioner that no change of status can spoil.
module amontons_schur_interface
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type, set_error, EXIT_SOLVER
  use amontons_sparse, only: sparse_type, reduction_type, from_triplets, transpose_of, analyse_reduction, reduce_matrix, &
    is_same_pattern
  use amontons_dense, only: factorise_dense, solve_dense, measure_matrix, is_rank_lost, triangle_times, square_of_triangle, DENSE_OK
  use amontons_woodbury_interface, only: sprung_type, springs_type, invert_stiffness, couple_springs, solve_springs
  use amontons_partition, only: order_unknowns
  use amontons_factorization, only: factor_type, analyse, factorise, elimination_order, trailing_block, solve_forward, &
    solve_backward, FACTOR_OK
  use amontons_constraints, only: constraints_type
  implicit none
  private
  public :: condensed_type, is_analysed_for, analyse_bulk, factorise_bulk, factorise_interface, factorise_springs, &
    apply_condensed

  integer, parameter :: WIDTH = 8                  !< columns of J_c that are made together: a vector of doubles [-]
  real(DP), parameter :: INSIDE = 1.0e-3_DP        !< of what is allowed: so little that single precision does not show [-]
  real(DP), parameter :: NEGLIGIBLE = 0.3_DP       !< of what is allowed: what the bulk may be out of balance [-]

  !> The bulk's factor and the interface's.
  type :: condensed_type
    logical :: is_analysed = .false.
    type(sparse_type), private :: analysed_map     !< C_b whose pattern was analysed
    logical :: is_ready = .false.                  !< the bulk is factorised
    integer :: n_contact = 0                       !< unknowns of the interface
    integer, allocatable :: contact_of(:)          !< (n base free) place in the interface, 0 if not on it
    integer, allocatable :: order(:)               !< (n base free) order of elimination; the interface comes last
    type(factor_type) :: factor
    type(reduction_type), private :: reduction
    type(sparse_type), private :: bulk             !< C_b' K C_b
    type(sparse_type), private :: matrix           !< the same with the interface's block full
    integer, allocatable, private :: target(:)     !< entry of matrix for each entry of bulk
    real(DP), allocatable, private :: triangle(:, :)   !< L_cc
    real(DP), allocatable, private :: shift(:)     !< (n_contact) D [force/length]
    real(DP), allocatable, private :: stiffness(:, :)  !< S; not there: not wanted yet
    logical :: is_invertible = .true.              !< S has an inverse in single precision
    logical :: is_singular = .false.               !< J_c is: nothing holds a body
    logical, private :: is_by_springs = .false.    !< factorise_springs came last
    type(sprung_type), private :: sprung           !< what that made
    real(DP) :: allowed = 0                        !< what apply_condensed may leave of a right-hand side [-]
    type(sparse_type), private :: relation         !< C_c (n_contact x n_reduced)
    type(sparse_type), private :: by_imbalance     !< D_R on the interface (n_contact x n_contact)
    integer, allocatable, private :: base_of(:)    !< (n free) base unknown of each free unknown
    integer, allocatable, private :: reduced_of(:) !< (n free) place among the reduced interface unknowns, 0 if none
    integer, private :: n_reduced = 0
    real(DP), allocatable, private :: lu(:, :)     !< J_c factorised
    integer, allocatable, private :: pivots(:)
  end type condensed_type

contains

  !> Whether the analysis holds for these constraints: a rigid body that turns couples unknowns that it did not couple before.
  pure logical function is_analysed_for(self, base) result(is_analysed)
    type(condensed_type), intent(in) :: self
    type(constraints_type), intent(in) :: base     !< finished
    is_analysed = self%is_analysed
    if (is_analysed) is_analysed = is_same_pattern(base%map, self%analysed_map)
  end function is_analysed_for


  !> Orders the bulk with the interface last and analyses it. After: is_analysed, or .false. if the interface did not stay last.
  subroutine analyse_bulk(self, stiffness, base, is_contact, error)
    type(condensed_type), intent(inout) :: self
    type(sparse_type), intent(in) :: stiffness     !< K, upper triangle (n_unknowns x n_unknowns)
    type(constraints_type), intent(in) :: base     !< boundary conditions, equations, followers: finished
    logical, intent(in) :: is_contact(:)           !< (n_unknowns) contact can reach it
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: order(:), node(:)
    integer :: i, n
    self%is_analysed = .false.
    self%is_ready = .false.
    n = base%n_free
    if (allocated(self%contact_of)) deallocate (self%contact_of)
    allocate (self%contact_of(n), node(n))
    self%n_contact = 0
    do i = 1, base%n_unknowns
      if (base%free_of(i) == 0) cycle
      node(base%free_of(i)) = (i + 2) / 3
      if (is_contact(i)) self%n_contact = self%n_contact + 1
      self%contact_of(base%free_of(i)) = merge(self%n_contact, 0, is_contact(i))
    end do
    call analyse_reduction(stiffness, base%map, self%reduction, self%bulk, error)
    if (allocated(error)) return
    self%analysed_map = base%map
    call fill_interface(self)
    call order_unknowns(self%bulk, node, base%n_unknowns / 3, order, error)
    if (allocated(error)) return
    order = [pack(order, self%contact_of(order) == 0), pack(order, self%contact_of(order) > 0)]
    call analyse(self%factor, self%matrix, order, error)
    if (allocated(error)) return
    call elimination_order(self%factor, order)
    self%is_analysed = all(self%contact_of(order(n - self%n_contact + 1:)) > 0)
    if (.not. self%is_analysed) return
    do i = 1, self%n_contact                       ! the interface is numbered as it is eliminated
      self%contact_of(order(n - self%n_contact + i)) = i
    end do
    call move_alloc(order, self%order)
  end subroutine analyse_bulk


  !> The pattern of the bulk with all pairs of interface unknowns, so that CHOLMOD keeps them together and last.
  subroutine fill_interface(self)
    type(condensed_type), intent(inout) :: self
    integer, allocatable :: members(:)
    integer :: i, k, n, p, total
    members = pack([(i, i=1, self%bulk%n_rows)], self%contact_of > 0)
    total = size(self%bulk%column) + self%n_contact * (self%n_contact + 1) / 2
    associate (matrix => self%matrix, bulk => self%bulk)
      matrix%n_rows = bulk%n_rows
      matrix%n_columns = bulk%n_columns
      if (allocated(matrix%first)) deallocate (matrix%first, matrix%column)
      if (allocated(self%target)) deallocate (self%target)
      allocate (matrix%first(bulk%n_rows + 1), matrix%column(total), self%target(size(bulk%column)))
      n = 0
      k = 0                                        ! interface unknowns met
      do i = 1, bulk%n_rows
        matrix%first(i) = n + 1
        if (self%contact_of(i) > 0) then
          k = k + 1
          call merge_row(i, members(k:))
        else
          do p = bulk%first(i), bulk%first(i + 1) - 1
            n = n + 1
            matrix%column(n) = bulk%column(p)
            self%target(p) = n
          end do
        end if
      end do
      matrix%first(bulk%n_rows + 1) = n + 1
      matrix%column = matrix%column(:n)
    end associate

  contains

    !> A row of the bulk merged with the interface unknowns from the diagonal on; both ascend.
    subroutine merge_row(row, list)
      integer, intent(in) :: row, list(:)
      integer :: q, a, b, last
      integer :: m
      q = self%bulk%first(row)
      last = self%bulk%first(row + 1)
      m = 1
      do while (q < last .or. m <= size(list))
        a = huge(a)
        b = huge(b)
        if (q < last) a = self%bulk%column(q)
        if (m <= size(list)) b = list(m)
        n = n + 1
        self%matrix%column(n) = min(a, b)
        if (a <= b) self%target(q) = n
        if (a <= b) q = q + 1
        if (b <= a) m = m + 1
      end do
    end subroutine merge_row

  end subroutine fill_interface


  !> Factorises the bulk and takes the condensed stiffness of the interface out of its factor.
  subroutine factorise_bulk(self, stiffness, base, status, error)
    type(condensed_type), intent(inout) :: self    !< analysed
    type(sparse_type), intent(in) :: stiffness     !< K
    type(constraints_type), intent(in) :: base
    integer, intent(out) :: status                 !< FACTOR_...
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: shift(:)
    integer :: i, n, no_memory
    self%is_ready = .false.
    n = self%bulk%n_rows
    call reduce_matrix(self%reduction, stiffness, base%map, self%bulk, error)
    if (allocated(error)) return
    allocate (self%matrix%value(size(self%matrix%column)), stat=no_memory)
    if (no_memory == 0) allocate (shift(n), stat=no_memory)
    call judge_memory(no_memory, error)
    if (allocated(error)) return
    self%matrix%value = 0
    self%matrix%value(self%target) = self%bulk%value
    shift = merge(abs(self%bulk%value(self%bulk%first(:n))), 0.0_DP, self%contact_of > 0)
    where (self%contact_of > 0 .and. shift <= 0.0_DP) shift = maxval(shift)   ! a rigid body that contact alone holds
    deallocate (self%bulk%value)                   ! the values are not wanted again, and the factor needs the room
    call factorise(self%factor, self%matrix, status, shift, error)
    deallocate (self%matrix%value)
    if (allocated(error) .or. status /= FACTOR_OK) return
    if (allocated(self%triangle)) deallocate (self%triangle)
    if (allocated(self%stiffness)) deallocate (self%stiffness)
    if (allocated(self%shift)) deallocate (self%shift)
    allocate (self%triangle(self%n_contact, self%n_contact), stat=no_memory)
    if (no_memory == 0) allocate (self%shift(self%n_contact), stat=no_memory)
    call judge_memory(no_memory, error)
    if (allocated(error)) return
    call trailing_block(self%factor, self%triangle)
    do i = 1, n
      if (self%contact_of(i) > 0) self%shift(self%contact_of(i)) = shift(i)
    end do
    self%sprung%is_inverse = .false.
    self%is_invertible = .true.
    self%is_ready = .true.
  end subroutine factorise_bulk


  !> S = L_cc L_cc' - D.
  subroutine restore_stiffness(self, error)
    type(condensed_type), intent(inout) :: self
    type(error_type), allocatable, intent(inout) :: error
    integer :: k, no_memory
    if (allocated(self%stiffness)) return
    allocate (self%stiffness(self%n_contact, self%n_contact), stat=no_memory)
    call judge_memory(no_memory, error)
    if (allocated(error)) return
    call square_of_triangle(self%triangle, self%stiffness)
    do k = 1, self%n_contact
      self%stiffness(k, k) = self%stiffness(k, k) - self%shift(k)
    end do
  end subroutine restore_stiffness


  !> J_c for the present statuses, weights and friction, factorised.
  !!
  !! After: is_complete is .false. if contact reaches unknowns that are not on the interface; then nothing else is made. is_singular
  !! tells whether J_c has no inverse, to rounding: what it makes of a force is not to be used then.
  subroutine factorise_interface(self, base, whole, by_imbalance, by_displacement, is_complete, error)
    type(condensed_type), intent(inout) :: self
    type(constraints_type), intent(in) :: base     !< without contact rows
    type(constraints_type), intent(in) :: whole    !< with them
    type(sparse_type), intent(in) :: by_imbalance      !< D_R (n_unknowns x n_unknowns) [-]
    type(sparse_type), intent(in) :: by_displacement   !< D_u (n_unknowns x n_unknowns) [force/length]
    logical, intent(out) :: is_complete
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: d_u
    real(DP), allocatable :: row(:), column(:)     ! (n_reduced) sizes of the rows and columns of J_c
    integer :: status
    call relate(self, base, whole, is_complete, error)
    if (allocated(error) .or. .not. is_complete) return
    call restore_stiffness(self, error)
    if (allocated(error)) return
    self%is_by_springs = .false.
    call restrict(self, base, by_imbalance, self%by_imbalance, error)
    if (allocated(error)) return
    call restrict(self, base, by_displacement, d_u, error)
    if (allocated(error)) return
    call fill_dense(self, transpose_of(self%relation), transpose_of(d_u), error)
    if (allocated(error)) return
    if (allocated(self%pivots)) deallocate (self%pivots)
    allocate (self%pivots(self%n_reduced), row(self%n_reduced), column(self%n_reduced))
    call measure_matrix(self%lu, row, column)
    call factorise_dense(self%lu, self%pivots, status)
    self%is_singular = status /= DENSE_OK
    if (.not. self%is_singular) self%is_singular = is_rank_lost(self%lu, self%pivots, row, column)
  end subroutine factorise_interface


  !> Errors: EXIT_SOLVER if there was no room.
  subroutine judge_memory(no_memory, error)
    integer, intent(in) :: no_memory               !< status of an allocation
    type(error_type), allocatable, intent(inout) :: error
    if (no_memory /= 0) call set_error(error, EXIT_SOLVER, 'Not enough memory for the interface of contact.')
  end subroutine judge_memory


  !> The same where all contact is by springs (`sprung`). After: is_fit is .false. where S has no inverse, or they are too stiff.
  subroutine factorise_springs(self, base, whole, springs, is_complete, is_fit, error)
    type(condensed_type), intent(inout) :: self
    type(constraints_type), intent(in) :: base     !< without contact rows
    type(constraints_type), intent(in) :: whole    !< the same
    type(springs_type), intent(in) :: springs      !< on all unknowns in place of those of the interface
    logical, intent(out) :: is_complete, is_fit
    type(error_type), allocatable, intent(out) :: error
    type(springs_type) :: taken
    is_fit = .false.
    self%is_singular = .false.
    call relate(self, base, whole, is_complete, error)
    if (allocated(error) .or. .not. is_complete) return
    if (self%n_reduced < self%n_contact) return
    if (.not. self%sprung%is_inverse) then
      if (allocated(self%stiffness)) deallocate (self%stiffness)
      call invert_stiffness(self%sprung, self%triangle, self%shift, error)
      if (allocated(error)) return
      self%is_invertible = self%sprung%is_inverse
      if (.not. self%is_invertible) return
    end if
    call take_springs(self, base, springs, taken, error)
    if (allocated(error)) return
    self%by_imbalance = empty_square(self%n_contact)
    call couple_springs(self%sprung, taken, is_fit, error)
    self%is_by_springs = is_fit
  end subroutine factorise_springs


  !> The springs on the interface.
  subroutine take_springs(self, base, springs, taken, error)
    type(condensed_type), intent(in) :: self
    type(constraints_type), intent(in) :: base
    type(springs_type), intent(in) :: springs
    type(springs_type), intent(out) :: taken
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: turned
    call take_to_interface(self, base, springs%spread, taken%spread, error)
    if (allocated(error)) return
    call take_to_interface(self, base, transpose_of(springs%follow), turned, error)
    if (allocated(error)) return
    taken%follow = transpose_of(turned)
    call take_to_interface(self, base, springs%moved, taken%moved, error)
    if (allocated(error)) return
    call take_to_interface(self, base, transpose_of(springs%moving), turned, error)
    if (.not. allocated(error)) taken%moving = transpose_of(turned)
  end subroutine take_springs


  !> A matrix without entries.
  pure function empty_square(n) result(matrix)
    integer, intent(in) :: n
    type(sparse_type) :: matrix
    integer :: i
    matrix%n_rows = n
    matrix%n_columns = n
    matrix%first = [(1, i=1, n + 1)]
    allocate (matrix%column(0), matrix%value(0))
  end function empty_square


  !> C_b' M, and of it the rows of the interface.
  subroutine take_to_interface(self, base, matrix, taken, error)
    type(condensed_type), intent(in) :: self
    type(constraints_type), intent(in) :: base
    type(sparse_type), intent(in) :: matrix        !< (n_unknowns x n)
    type(sparse_type), intent(out) :: taken        !< (n_contact x n)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: i, a, p, n, pass
    do pass = 1, 2
      n = 0
      do i = 1, matrix%n_rows
        if (matrix%first(i) == matrix%first(i + 1)) cycle
        do a = base%map%first(i), base%map%first(i + 1) - 1
          if (self%contact_of(base%map%column(a)) == 0) cycle
          do p = matrix%first(i), matrix%first(i + 1) - 1
            n = n + 1
            if (pass == 1) cycle
            row(n) = self%contact_of(base%map%column(a))
            column(n) = matrix%column(p)
            value(n) = base%map%value(a) * matrix%value(p)
          end do
        end do
      end do
      if (pass == 1) allocate (row(n), column(n), value(n))
    end do
    call from_triplets(self%n_contact, matrix%n_columns, row, column, value, taken, error)
  end subroutine take_to_interface


  !> The springs' solution for a right-hand side on the free unknowns of the interface: C_c only sorts here.
  subroutine solve_sorted(self, r)
    type(condensed_type), intent(inout), target :: self
    real(DP), intent(inout) :: r(:)                !< (n_contact) in the order of the free unknowns
    type(error_type), allocatable :: error         ! no memory: what comes out is not the solution, and GMRES finds that
    real(DP) :: t(self%n_contact)
    integer :: k
    associate (place => self%relation%column, first => self%relation%first)
      t = [(r(place(first(k))), k=1, self%n_contact)]
      call solve_springs(self%sprung, self%triangle, self%shift, INSIDE * self%allowed, t, error)
      do k = 1, self%n_contact
        r(place(first(k))) = t(k)
      end do
    end associate
  end subroutine solve_sorted


  !> C_c, and the places of the free unknowns in bulk and interface.
  subroutine relate(self, base, whole, is_complete, error)
    type(condensed_type), intent(inout) :: self
    type(constraints_type), intent(in) :: base, whole
    logical, intent(out) :: is_complete
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: i, c, p, n
    if (allocated(self%base_of)) deallocate (self%base_of, self%reduced_of)
    allocate (self%base_of(whole%n_free), self%reduced_of(whole%n_free))
    self%n_reduced = 0
    do i = 1, whole%n_unknowns
      if (whole%free_of(i) == 0) cycle
      self%base_of(whole%free_of(i)) = base%free_of(i)
      c = self%contact_of(base%free_of(i))
      if (c > 0) self%n_reduced = self%n_reduced + 1
      self%reduced_of(whole%free_of(i)) = merge(self%n_reduced, 0, c > 0)
    end do
    is_complete = .false.
    allocate (row(size(whole%map%column)), column(size(whole%map%column)), value(size(whole%map%column)))
    n = 0
    do i = 1, base%n_unknowns
      if (base%free_of(i) == 0) cycle
      c = self%contact_of(base%free_of(i))
      if (c == 0 .and. whole%free_of(i) == 0) return
      if (c == 0) cycle
      do p = whole%map%first(i), whole%map%first(i + 1) - 1
        n = n + 1
        row(n) = c
        column(n) = self%reduced_of(whole%map%column(p))
        value(n) = whole%map%value(p)
        if (column(n) == 0) return
      end do
    end do
    is_complete = .true.
    call from_triplets(self%n_contact, self%n_reduced, row(:n), column(:n), value(:n), self%relation, error)
  end subroutine relate


  !> C_b' M C_b on the interface alone.
  subroutine restrict(self, base, matrix, restricted, error)
    type(condensed_type), intent(in) :: self
    type(constraints_type), intent(in) :: base
    type(sparse_type), intent(in) :: matrix        !< (n_unknowns x n_unknowns)
    type(sparse_type), intent(out) :: restricted   !< (n_contact x n_contact)
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: i, p, n, pass
    do pass = 1, 2
      n = 0
      do i = 1, matrix%n_rows
        do p = matrix%first(i), matrix%first(i + 1) - 1
          call put(i, matrix%column(p), matrix%value(p))
        end do
      end do
      if (pass == 1) allocate (row(n), column(n), value(n))
    end do
    call from_triplets(self%n_contact, self%n_contact, row, column, value, restricted, error)

  contains

    !> One entry, spread over the free unknowns on which its row and its column depend.
    subroutine put(r, c, v)
      integer, intent(in) :: r, c
      real(DP), intent(in) :: v
      integer :: a, b
      do a = base%map%first(r), base%map%first(r + 1) - 1
        if (self%contact_of(base%map%column(a)) == 0) cycle
        do b = base%map%first(c), base%map%first(c + 1) - 1
          if (self%contact_of(base%map%column(b)) == 0) cycle
          n = n + 1
          if (pass == 1) cycle
          row(n) = self%contact_of(base%map%column(a))
          column(n) = self%contact_of(base%map%column(b))
          value(n) = base%map%value(a) * v * base%map%value(b)
        end do
      end do
    end subroutine put

  end subroutine restrict


  !> J_c = C_c' ((1 + D_R) S - D_u) C_c, some columns at a time; threads share them.
  subroutine fill_dense(self, relation_t, d_u_t, error)
    type(condensed_type), intent(inout) :: self
    type(sparse_type), intent(in) :: relation_t    !< C_c' (n_reduced x n_contact)
    type(sparse_type), intent(in) :: d_u_t         !< D_u' (n_contact x n_contact)
    type(error_type), allocatable, intent(inout) :: error
    integer :: j, no_memory
    if (allocated(self%lu)) deallocate (self%lu)
    allocate (self%lu(self%n_reduced, self%n_reduced), stat=no_memory)
    call judge_memory(no_memory, error)
    if (allocated(error)) return
    !$omp parallel do schedule(static)
    do j = 1, self%n_reduced, WIDTH
      call fill_columns(self, relation_t, d_u_t, j, min(j + WIDTH - 1, self%n_reduced))
    end do
    !$omp end parallel do
  end subroutine fill_dense


  !> Columns of J_c, side by side in memory, so that the sparse matrices are gone through once for all of them.
  subroutine fill_columns(self, relation_t, d_u_t, first, last)
    type(condensed_type), intent(inout) :: self
    type(sparse_type), intent(in) :: relation_t, d_u_t
    integer, intent(in) :: first, last             !< at most WIDTH columns
    real(DP) :: t(WIDTH, self%n_contact), w(WIDTH, self%n_contact), row(WIDTH)
    integer :: j, m, p, q, k
    t = 0.0_DP
    do j = first, last
      m = j - first + 1
      do p = relation_t%first(j), relation_t%first(j + 1) - 1
        t(m, :) = t(m, :) + relation_t%value(p) * self%stiffness(:, relation_t%column(p))
      end do
    end do
    w = t
    do k = 1, self%n_contact
      do p = self%by_imbalance%first(k), self%by_imbalance%first(k + 1) - 1
        w(:, k) = w(:, k) + self%by_imbalance%value(p) * t(:, self%by_imbalance%column(p))
      end do
    end do
    do j = first, last
      m = j - first + 1
      do p = relation_t%first(j), relation_t%first(j + 1) - 1
        k = relation_t%column(p)
        do q = d_u_t%first(k), d_u_t%first(k + 1) - 1
          w(m, d_u_t%column(q)) = w(m, d_u_t%column(q)) - relation_t%value(p) * d_u_t%value(q)
        end do
      end do
    end do
    do k = 1, self%n_reduced
      row = 0.0_DP
      do p = relation_t%first(k), relation_t%first(k + 1) - 1
        row = row + relation_t%value(p) * w(:, relation_t%column(p))
      end do
      self%lu(k, first:last) = row(:last - first + 1)
    end do
  end subroutine fill_columns


  !> x = inv(J) r with the bulk as it was factorised: forward through the bulk, the interface, backward through the bulk. Forward
  !! there is nothing to do where only the interface is out of balance.
  subroutine apply_condensed(self, r, x)
    type(condensed_type), intent(inout), target :: self
    real(DP), intent(in) :: r(:)                   !< (n free) [force]
    real(DP), intent(out) :: x(:)                  !< (n free) [length]
    real(DP), allocatable :: b(:), y(:), h(:), g(:), r_c(:)
    integer :: n, m, j, k, p
    n = size(self%order)
    m = n - self%n_contact
    allocate (b(n), y(n), h(self%n_contact), r_c(self%n_reduced))
    b = 0.0_DP
    do j = 1, size(r)
      if (self%reduced_of(j) == 0) b(self%base_of(j)) = r(j)
      if (self%reduced_of(j) > 0) r_c(self%reduced_of(j)) = r(j)
    end do
    y = 0.0_DP
    h = 0.0_DP
    if (norm2(b) > NEGLIGIBLE * self%allowed) then
      call solve_forward(self%factor, b(self%order), y)
      h = y(m + 1:)
      call triangle_times(self%triangle, .false., h)   ! - K_ci inv(K_ii) r_i
    end if
    g = h
    do k = 1, self%n_contact
      do p = self%by_imbalance%first(k), self%by_imbalance%first(k + 1) - 1
        g(k) = g(k) + self%by_imbalance%value(p) * h(self%by_imbalance%column(p))
      end do
    end do
    do k = 1, self%n_contact
      do p = self%relation%first(k), self%relation%first(k + 1) - 1
        r_c(self%relation%column(p)) = r_c(self%relation%column(p)) + self%relation%value(p) * g(k)
      end do
    end do
    if (self%is_by_springs) then
      call solve_sorted(self, r_c)
    else
      call solve_dense(self%lu, self%pivots, r_c)
    end if
    do k = 1, self%n_contact
      h(k) = 0.0_DP
      do p = self%relation%first(k), self%relation%first(k + 1) - 1
        h(k) = h(k) + self%relation%value(p) * r_c(self%relation%column(p))
      end do
    end do
    call triangle_times(self%triangle, .true., h)
    y(m + 1:) = h
    call solve_backward(self%factor, y, b)
    y(self%order) = b
    do j = 1, size(x)
      if (self%reduced_of(j) > 0) then
        x(j) = r_c(self%reduced_of(j))
      else
        x(j) = y(self%base_of(j))
      end if
    end do
  end subroutine apply_condensed

end module amontons_schur_interface
