!> Factor of the matrix of a coarse space, in single precision, divided among the ranks.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! An unknown of the coarse space is a column of Z. The unknowns with entries of Z in the rows of one rank alone are the inner ones
!! of this rank, and the others are the border; so are those that A = Z'KZ couples with inner ones of a higher rank:
!!
!!           | A_11       A_1b |
!!     A  =  |      A_22  A_2b |
!!           | A_b1 A_b2  A_bb |
!!
!! Each rank r factorizes its inner block with the border behind it. The last block of its factor L gives what is left of A_bb, and
!! with those of all p ranks the Schur complement S of the border, which each rank factorizes:
!!
!!     L_b L_b' = A_bb - A_br inv(A_rr) A_rb,     S = sum over r of L_b L_b' - (p - 1) A_bb
!!
!! A solution has one sum over the ranks, of the border alone: of Z'r there and of what the inner unknowns leave. If the border is
!! large, each rank has the whole factor, and Z'r is summed.
!! Reference: Smith, Bjorstad, Gropp, Domain Decomposition, Cambridge 1996, sec. 4.2 (Schur complements of subdomains).
module amontons_divided_coarse_factor
  use amontons_kinds, only: DP
  use amontons_containers, only: owners_of_entries
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets, sparse_sum
  use amontons_dense, only: triangular_product
  use amontons_graph_partition, only: order_unknowns
  use amontons_factorization, only: cholesky_type, analyse, factorise, round_factor, solve, elimination_order, trailing_block, &
    eliminate_inner, substitute_inner, FACTOR_OK, FACTOR_NOT_POSITIVE
  use amontons_coarse_factor, only: coarse_factor_type, factorise_whole, solve_whole, is_analysed_pattern, keep_pattern, &
    fill_empty_rows
  use amontons_mpi_ranks, only: this_rank, n_ranks, sum_over_ranks, join_parts, min_over_ranks, share_error
  implicit none
  private
  public :: divided_coarse_factor_type, divide_unknowns

  integer, parameter :: MIN_UNKNOWNS_PER_BORDER = 4   !< unknowns for each of the border; with fewer each rank has the whole factor:
                                                      !! that of the border is full, and each rank has it [-] | 0023

  !> The factor of one matrix.
  type, extends(coarse_factor_type) :: divided_coarse_factor_type
    private
    logical :: is_divided = .false.                !< `factor` is of the inner block of this rank with the border; else of A
    type(cholesky_type) :: border_factor           !< of S
    integer, allocatable :: unknown(:)             !< of `factor`, in the order of elimination: inner ones and the border
    integer :: n_border = 0
    type(sparse_type) :: matrix                    !< inner block and border, each pair of the border
    integer, allocatable :: source(:)              !< entry of A for each of its entries; 0: none
    integer, public :: n_summed = 0                !< unknowns of a solution that are summed over the ranks
  contains
    procedure :: factorise => factorise_shares
    procedure :: solve => solve_shares
  end type divided_coarse_factor_type

contains

  !> Factorizes a matrix, unless its factor would have too many entries. Collective.
  subroutine factorise_shares(self, matrix, is_held, max_entries, is_ready, error)
    class(divided_coarse_factor_type), intent(inout) :: self
    type(sparse_type), intent(inout) :: matrix     !< upper triangle; in: what this rank has of A; out: A
    logical, intent(in) :: is_held(:)              !< (n) its column of Z has entries in rows of this rank
    real(DP), intent(in) :: max_entries            !< of the factor
    logical, intent(out) :: is_ready               !< .false.: A is not positive definite, or the factor too large
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: owner(:)
    integer :: status
    is_ready = .false.
    call sum_matrix_over_ranks(matrix)
    if (n_ranks() > 1 .and. .not. is_analysed_pattern(self, matrix)) then
      call find_owners(matrix, is_held, owner)
      call divide_unknowns(self, matrix, owner, error)
      if (allocated(error)) return
    end if
    if (.not. self%is_divided) then
      call factorise_whole(self, matrix, is_held, max_entries, is_ready, error)
      return
    end if
    if (-min_over_ranks(-self%factor%n_entries) * real(n_ranks(), DP) > max_entries) return
    call fill_empty_rows(matrix)
    call factorise_divided(self, matrix, status, error)
    if (allocated(error)) return
    is_ready = status == FACTOR_OK
    if (is_ready) call round_factor(self%factor)
  end subroutine factorise_shares


  !> The sum of a square matrix over the ranks, whose patterns may differ, in pairs, pairs of pairs and so on.
  subroutine sum_matrix_over_ranks(matrix)
    type(sparse_type), intent(inout) :: matrix
    type(sparse_type), allocatable :: parts(:)
    integer :: r, step
    call join_matrices(matrix, parts)
    step = 1
    do while (step < size(parts))
      do r = 1, size(parts) - step, 2 * step
        parts(r) = sparse_sum(parts(r), 1.0_DP, parts(r + step))
        parts(r + step) = sparse_type()
      end do
      step = 2 * step
    end do
    matrix = parts(1)
  end subroutine sum_matrix_over_ranks


  !> The matrices of all ranks.
  subroutine join_matrices(matrix, parts)
    type(sparse_type), intent(in) :: matrix        !< of this one, with as many rows as the others
    type(sparse_type), allocatable, intent(out) :: parts(:)   !< (ranks)
    real(DP), allocatable :: first(:), column(:), value(:)
    integer :: r, n, n_before, m
    call join_parts(real(matrix%first, DP), first)
    call join_parts(real(matrix%column, DP), column)
    call join_parts(matrix%value, value)
    n = matrix%n_rows
    allocate (parts(n_ranks()))
    n_before = 0
    do r = 1, size(parts)
      parts(r)%n_rows = n
      parts(r)%n_columns = n
      parts(r)%first = nint(first((r - 1) * (n + 1) + 1:r * (n + 1)))
      m = n_before + parts(r)%first(n + 1) - 1
      parts(r)%column = nint(column(n_before + 1:m))
      parts(r)%value = value(n_before + 1:m)
      n_before = m
    end do
  end subroutine join_matrices


  !> Divides a factor, unless the border is too large, and analyses the share of this rank. Collective.
  subroutine divide_unknowns(self, matrix, owner, error)
    class(divided_coarse_factor_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix        !< A
    integer, intent(in) :: owner(:)                !< (n) rank of which an unknown is an inner one; -1: the border
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: inner(:), order(:)
    logical :: is_last
    integer :: i, n
    self%is_divided = .false.
    self%n_summed = size(owner)
    self%n_border = count(owner < 0)
    if (self%n_border * MIN_UNKNOWNS_PER_BORDER > size(owner)) return
    inner = pack([(i, i=1, size(owner))], owner == this_rank())
    self%unknown = [inner, pack([(i, i=1, size(owner))], owner < 0)]
    n = size(inner)
    call take_block(self, matrix, n, error)        ! for the order of the inner unknowns alone
    if (n > 0 .and. .not. allocated(error)) then
      call order_unknowns(self%matrix, [(i, i=1, n)], n, order, error)
      if (.not. allocated(error)) self%unknown(:n) = inner(order)
    end if
    if (.not. allocated(error)) call take_block(self, matrix, size(self%unknown), error)
    if (.not. allocated(error)) call analyse(self%factor, self%matrix, [(i, i=1, size(self%unknown))], error, self%n_border)
    call share_error(error)
    if (allocated(error)) return
    order = [(i, i=1, size(self%unknown))]
    call elimination_order(self%factor, order)
    is_last = all(order(n + 1:) == [(i, i=n + 1, size(order))])
    self%is_divided = min_over_ranks(merge(1.0_DP, 0.0_DP, is_last)) > 0.5_DP
    if (.not. self%is_divided) return
    self%unknown = self%unknown(order)             ! that of the matrix is another one for the inner unknowns
    self%n_summed = self%n_border
    call analyse_border(self, error)
    call share_error(error)
    if (.not. allocated(error)) call keep_pattern(self, matrix)
  end subroutine divide_unknowns


  !> The rank of which each unknown is an inner one; -1: the border.
  subroutine find_owners(matrix, is_held, owner)
    type(sparse_type), intent(in) :: matrix
    logical, intent(in) :: is_held(:)
    integer, allocatable, intent(out) :: owner(:)
    real(DP) :: holders(size(is_held), 2)          ! number of ranks, and sum of their numbers
    integer :: i, j, p
    holders(:, 1) = merge(1.0_DP, 0.0_DP, is_held)
    holders(:, 2) = holders(:, 1) * real(this_rank(), DP)
    call sum_over_ranks(holders)
    owner = merge(nint(holders(:, 2)), -1, nint(holders(:, 1)) <= 1)
    do i = 1, matrix%n_rows
      do p = matrix%first(i), matrix%first(i + 1) - 1
        j = matrix%column(p)
        if (min(owner(i), owner(j)) < 0 .or. owner(i) == owner(j)) cycle
        if (owner(i) < owner(j)) then
          owner(i) = -1
        else
          owner(j) = -1
        end if
      end do
    end do
  end subroutine find_owners


  !> The block of A between the first unknowns of this rank, in their order, with each pair of those of the border.
  subroutine take_block(self, matrix, n, error)
    class(divided_coarse_factor_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: n                       !< unknowns
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: place(:), row(:), column(:), entry(:)
    integer :: i
    allocate (place(matrix%n_rows), source=0)
    place(self%unknown(:n)) = [(i, i=1, n)]
    row = place(owners_of_entries(matrix%first))
    column = place(matrix%column)
    entry = pack([(i, i=1, size(row))], min(row, column) > 0)
    row = row(entry)
    column = column(entry)
    call sparse_from_triplets(n, n, min(row, column), max(row, column), real(entry, DP), self%matrix, error)
    if (allocated(error)) return
    call fill_border(self%matrix, size(self%unknown) - self%n_border)
    self%source = nint(self%matrix%value)
  end subroutine take_block


  !> Makes the rows of the border full.
  pure subroutine fill_border(matrix, n_inner)
    type(sparse_type), intent(inout) :: matrix     !< upper triangle; entries that are added have the value 0
    integer, intent(in) :: n_inner                 !< rows before
    type(sparse_type) :: border
    integer :: i, p, m
    call create_triangle(matrix%n_rows - n_inner, border)
    do i = 1, border%n_rows
      do p = matrix%first(n_inner + i), matrix%first(n_inner + i + 1) - 1
        border%value(border%first(i) + matrix%column(p) - n_inner - i) = matrix%value(p)
      end do
    end do
    m = matrix%first(n_inner + 1) - 1              ! entries of the rows before
    matrix%column = [matrix%column(:m), n_inner + border%column]
    matrix%value = [matrix%value(:m), border%value]
    matrix%first(n_inner + 1:) = m + border%first
  end subroutine fill_border


  !> Analyses the full matrix of the border.
  subroutine analyse_border(self, error)
    class(divided_coarse_factor_type), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: pattern
    integer :: i
    call create_triangle(self%n_border, pattern)
    call analyse(self%border_factor, pattern, [(i, i=1, self%n_border)], error)
  end subroutine analyse_border


  !> The upper triangle of a symmetric matrix without zeros; its values are 0.
  pure subroutine create_triangle(n, matrix)
    integer, intent(in) :: n                       !< rows
    type(sparse_type), intent(out) :: matrix
    integer :: i, j
    matrix%n_rows = n
    matrix%n_columns = n
    matrix%first = [(1 + (i - 1) * n - (i - 1) * (i - 2) / 2, i=1, n + 1)]
    matrix%column = [((j, j=i, n), i=1, n)]
    allocate (matrix%value(size(matrix%column)), source=0.0_DP)
  end subroutine create_triangle


  !> Factorizes the inner block of this rank and the border.
  subroutine factorise_divided(self, matrix, status, error)
    class(divided_coarse_factor_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer, intent(out) :: status                 !< FACTOR_..., the same on all ranks
    type(error_type), allocatable, intent(out) :: error
    real(DP), allocatable :: triangle(:, :), schur(:, :)
    type(sparse_type) :: border
    integer :: i, p, n_inner
    real(DP) :: others                             ! ranks beside this one
    do i = 1, size(self%source)
      self%matrix%value(i) = 0
      if (self%source(i) > 0) self%matrix%value(i) = matrix%value(self%source(i))
    end do
    call factorise(self%factor, self%matrix, status, error=error)
    if (min_over_ranks(merge(1.0_DP, 0.0_DP, status == FACTOR_OK .and. .not. allocated(error))) < 0.5_DP) then
      if (status == FACTOR_OK) status = FACTOR_NOT_POSITIVE
      return
    end if
    allocate (triangle(self%n_border, self%n_border), schur(self%n_border, self%n_border))
    call trailing_block(self%factor, triangle)
    call triangular_product(triangle, schur)
    deallocate (triangle)
    call sum_over_ranks(schur)
    n_inner = size(self%unknown) - self%n_border
    others = real(n_ranks() - 1, DP)
    do i = n_inner + 1, size(self%unknown)
      do p = self%matrix%first(i), self%matrix%first(i + 1) - 1
        associate (j => self%matrix%column(p))
          schur(j - n_inner, i - n_inner) = schur(j - n_inner, i - n_inner) - others * self%matrix%value(p)
        end associate
      end do
    end do
    call create_triangle(self%n_border, border)
    do i = 1, self%n_border
      border%value(border%first(i):border%first(i + 1) - 1) = schur(i:, i)
    end do
    call factorise(self%border_factor, border, status, error=error)
    if (status == FACTOR_OK .and. .not. allocated(error)) call round_factor(self%border_factor)
  end subroutine factorise_divided


  !> c becomes inv(A) c; in: c is Z'r of the own rows of each rank. A divided factor solves for the unknowns that have entries in
  !! own rows, and gives 0 for the others.
  subroutine solve_shares(self, c)
    class(divided_coarse_factor_type), intent(in) :: self   !< ready
    real(DP), allocatable, intent(inout) :: c(:)
    real(DP), allocatable :: x(:), border(:)
    integer :: n_inner
    if (.not. self%is_divided) then
      call sum_over_ranks(c)
      call solve_whole(self, c)
      return
    end if
    n_inner = size(self%unknown) - self%n_border
    allocate (x(size(self%unknown)), source=0.0_DP)
    x(:n_inner) = c(self%unknown(:n_inner))
    call eliminate_inner(self%factor, self%n_border, x)
    border = c(self%unknown(n_inner + 1:)) + x(n_inner + 1:)
    call sum_over_ranks(border)
    call solve(self%border_factor, border, x(n_inner + 1:))
    call substitute_inner(self%factor, self%n_border, x)
    c = 0
    c(self%unknown) = x
  end subroutine solve_shares

end module amontons_divided_coarse_factor
