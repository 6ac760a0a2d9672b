!> Coarse space of the contact skin: smooth displacements that patches of the Robin springs cause, and the correction in their span.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/solver.md, "The contact skin". For each patch of slave nodes and each axis, e has the displacement 1 at the
!! nodes of the patch. With the springs S and P = inv(K + S), the coarse space is spanned by
!!
!!     W = P S e,     K W = S (e - W),
!!
!! the displacements that the springs cause when they drag the bodies along. Where contact is open or slides, P is too stiff in just
!! these directions. K W has entries at the springs alone; therefore J W and E = W'J W cost a few products with rows of the
!! skin for each tangent. The numbers only precondition, so that single precision suffices.
!! References: R. A. Nicolaides, SIAM J. Numer. Anal. 24 (1987) 355 (deflation by subdomains); B. Smith, P. Bjorstad, W. Gropp,
!! Domain Decomposition, Cambridge 1996, section 2.2 (multiplicative coarse correction).
module amontons_contact_coarse_space
  use amontons_kinds, only: DP, SP
  use amontons_blas_lapack, only: dgetrf, dgetrs, sgemm, sgemv
  use amontons_sparse, only: sparse_type, multiply, multiply_symmetric
  use amontons_constraints, only: constraints_type, condense_forces
  use amontons_reduced_system, only: reduced_system_type, apply_reduced_inverse
  use amontons_point_partition, only: partition_points
  implicit none
  private
  public :: coarse_space_type, coarse_rows_type, build_coarse_space, update_coarse_space, apply_coarse_correction

  integer, parameter :: BLOCK_ROWS = 4096          !< rows of W of one product
  integer, parameter :: BLOCK_UNKNOWNS = 64        !< unknowns whose values of a block of directions fit into a cache
  integer, parameter :: BLOCK_DIRECTIONS = 32      !< directions of one pass: their sums fit into registers
  integer, parameter :: N_SHARES = 16              !< parts of a product, which threads share; sums do not depend on the threads

  !> The coarse space.
  type :: coarse_space_type
    integer :: n = 0                               !< directions; 0: no coarse space
    logical, private :: is_ready = .false.         !< E is regular
    real(SP), allocatable, private :: w(:, :)      !< W (n_unknowns, n) [-]
    integer, allocatable, private :: loaded(:)     !< unknowns with springs
    real(SP), allocatable, private :: force(:, :)  !< K W there, condensed (n, size(loaded)) [force/length]
    integer, allocatable, private :: free(:)       !< free unknowns where J W is not 0
    real(SP), allocatable, private :: test(:, :)   !< W there, with the contact rows (n, size(free)) [-]
    real(SP), allocatable, private :: image(:, :)  !< J W there (n, size(free)) [force/length]
    real(DP), allocatable, private :: lu(:, :)     !< LU factors of E (n, n)
    integer, allocatable, private :: pivots(:)
  end type coarse_space_type

  !> What the tangent J = T' ((1 + D_R) K - D_u) T consists of.
  type :: coarse_rows_type
    type(sparse_type), pointer :: stiffness => null()         !< K, upper triangle (n_unknowns x n_unknowns) [force/length]
    type(sparse_type), pointer :: rows => null()   !< A of contact (n_dependent x n_unknowns) [-]
    type(sparse_type), pointer :: directions => null()        !< D' of the projection onto A u = 0 (n_dependent x n_unknowns) [-]
    type(sparse_type), pointer :: by_imbalance => null()      !< D_R (n_unknowns x n_unknowns) [-]
    type(sparse_type), pointer :: by_displacement => null()   !< D_u (n_unknowns x n_unknowns) [force/length]
    type(sparse_type), pointer :: transformation => null()    !< T (n_unknowns x n_free) [-]
    integer, pointer :: bulk_of(:) => null()       !< (n_unknowns) 0: no free unknown of the bulk
    integer, pointer :: unknown_of(:) => null()    !< (n_free) index of each free unknown among all
  end type coarse_rows_type

contains

  !> W and K W. Cost: a solution with P and a product with S for each direction.
  subroutine build_coarse_space(self, robin, springs, base, place, is_slave, n_patches)
    type(coarse_space_type), intent(out) :: self
    type(reduced_system_type), intent(inout) :: robin         !< K + S and its factor
    type(sparse_type), intent(in) :: springs       !< S, upper triangle (n_unknowns x n_unknowns) [force/length]
    type(constraints_type), intent(in) :: base     !< without contact rows
    real(DP), intent(in) :: place(:, :)            !< (3, n_nodes) coordinates [length]
    logical, intent(in) :: is_slave(:)             !< (n_nodes)
    integer, intent(in) :: n_patches               !< about
    integer, allocatable :: node(:), patch(:)
    real(DP), dimension(base%n_unknowns) :: e, f, u
    logical :: is_loaded(base%n_unknowns)
    integer :: i, axis, t, n_used, k
    if (robin%is_iterative .or. n_patches == 0) return
    call mark_loaded(springs, is_loaded)
    node = pack([(i, i=1, size(is_slave))], is_slave .and. any(reshape(is_loaded, [3, size(is_slave)]), dim=1))
    if (size(node) <= n_patches) return
    allocate (patch(size(node)))
    call partition_points(place(:, node), (size(node) - 1) / n_patches + 1, patch, n_used)
    self%n = 3 * n_used
    self%loaded = pack([(i, i=1, base%n_unknowns)], is_loaded .and. base%owner == 0)
    allocate (self%w(base%n_unknowns, self%n), self%force(self%n, size(self%loaded)))
    k = 0
    do t = 1, n_used
      do axis = 1, 3
        k = k + 1
        e = 0.0_DP
        e(3 * (pack(node, patch == t) - 1) + axis) = 1.0_DP
        call multiply_symmetric(springs, e, f)
        call solve_bulk(robin, base, f, u)
        self%w(:, k) = real(u, SP)
        call multiply_symmetric(springs, e - u, f)
        u = reshape(condensed(base, f), [base%n_unknowns])
        self%force(k, :) = real(u(self%loaded), SP)
      end do
    end do
  end subroutine build_coarse_space


  !> The unknowns with springs.
  pure subroutine mark_loaded(springs, is_loaded)
    type(sparse_type), intent(in) :: springs
    logical, intent(out) :: is_loaded(:)           !< (n_unknowns)
    integer :: i, p
    is_loaded = .false.
    do i = 1, springs%n_rows
      do p = springs%first(i), springs%first(i + 1) - 1
        is_loaded([i, springs%column(p)]) = .true.
      end do
    end do
  end subroutine mark_loaded


  !> Forces, with those on dependent unknowns transferred to the free ones.
  function condensed(base, f) result(g)
    type(constraints_type), intent(in) :: base
    real(DP), intent(in) :: f(:)                   !< (n_unknowns) [force]
    real(DP) :: g(3, size(f) / 3)                  !< [force]
    call condense_forces(base, reshape(f, shape(g)), g)
  end function condensed


  !> u = T inv(K + S) T'f with the constraints of the bulk.
  subroutine solve_bulk(robin, base, f, u)
    type(reduced_system_type), intent(inout) :: robin
    type(constraints_type), intent(in) :: base
    real(DP), intent(in) :: f(:)                   !< (n_unknowns) [force]
    real(DP), intent(out) :: u(:)                  !< (n_unknowns) [length]
    real(DP) :: g(size(f)), b(base%n_free), y(base%n_free)
    integer :: i
    g = reshape(condensed(base, f), shape(g))
    do i = 1, size(f)
      if (base%free_of(i) > 0) b(base%free_of(i)) = g(i)
    end do
    call apply_reduced_inverse(robin, b, y)
    call multiply(base%transformation, y, u)
  end subroutine solve_bulk


  !> W with the contact rows, J W and the factors of E for a tangent, for BLOCK_DIRECTIONS directions at a time. Numbers are kept
  !! where J W has entries.
  subroutine update_coarse_space(self, tangent)
    type(coarse_space_type), intent(inout) :: self
    type(coarse_rows_type), intent(in) :: tangent
    integer, allocatable :: unknown(:), place(:), moved(:), free_place(:)
    real(SP), allocatable :: u(:, :), f(:, :), shift(:, :), e(:, :)
    integer :: status, first, n_moved
    if (self%n == 0) return
    call number_unknowns(self, tangent, place, unknown, moved)
    call number_free(self, tangent, unknown, free_place)
    n_moved = maxval([0, moved])
    allocate (e(self%n, self%n))
    !$omp parallel do private(u, f, shift) schedule(static, 1)
    do first = 1, self%n, BLOCK_DIRECTIONS
      allocate (u(BLOCK_DIRECTIONS, size(unknown)), f(BLOCK_DIRECTIONS, size(unknown)), shift(BLOCK_DIRECTIONS, n_moved))
      call gather(self, unknown, place, first, u, f)
      call project_onto_rows(tangent, place, moved, u, shift)
      call add_stiffness_product(tangent, place, unknown, moved, shift, f)
      call subtract_contact_forces(tangent, place, unknown, u, f)
      call restrict(self, tangent, place, unknown, free_place, first, u, f)
      deallocate (u, f, shift)
    end do
    !$omp end parallel do
    !$omp parallel do schedule(static, 1)
    do first = 1, self%n, BLOCK_DIRECTIONS         ! rows of E
      call sgemm('N', 'T', min(BLOCK_DIRECTIONS, self%n - first + 1), self%n, size(self%free), 1.0_SP, self%test(first, 1), &
        self%n, self%image, self%n, 0.0_SP, e(first, 1), self%n)
    end do
    !$omp end parallel do
    if (allocated(self%lu)) deallocate (self%lu, self%pivots)
    allocate (self%pivots(self%n))
    self%lu = real(e, DP)
    call dgetrf(self%n, self%n, self%lu, self%n, self%pivots, status)
    self%is_ready = status == 0
  end subroutine update_coarse_space


  !> W and K W of a block of directions at the numbered unknowns; zero beyond the last direction.
  subroutine gather(self, unknown, place, first, u, f)
    type(coarse_space_type), intent(in) :: self
    integer, intent(in) :: unknown(:)
    integer, intent(in) :: place(:)                !< (n_unknowns)
    integer, intent(in) :: first                   !< direction
    real(SP), intent(out), contiguous :: u(:, :), f(:, :)     !< (BLOCK_DIRECTIONS, unknowns)
    integer :: k, n, low, high
    n = min(BLOCK_DIRECTIONS, self%n - first + 1)
    u(n + 1:, :) = 0.0_SP
    do low = 1, size(unknown), BLOCK_UNKNOWNS
      high = min(low + BLOCK_UNKNOWNS - 1, size(unknown))
      do k = 1, n
        u(k, low:high) = self%w(unknown(low:high), first + k - 1)
      end do
    end do
    f = 0.0_SP
    do k = 1, size(self%loaded)
      f(:n, place(self%loaded(k))) = self%force(first:first + n - 1, k)
    end do
  end subroutine gather


  !> The unknowns where something is not 0: springs, rows, and all that the stiffness couples with the nodes that the rows move.
  subroutine number_unknowns(self, tangent, place, unknown, moved)
    type(coarse_space_type), intent(in) :: self
    type(coarse_rows_type), intent(in) :: tangent
    integer, allocatable, intent(out) :: place(:)  !< (n_unknowns) number; 0: none
    integer, allocatable, intent(out) :: unknown(:)   !< of each number
    integer, allocatable, intent(out) :: moved(:)  !< (n_unknowns) number among the moved ones; 0: the rows do not move it
    integer :: i, p
    allocate (place(size(tangent%bulk_of)), moved(size(tangent%bulk_of)), source=0)
    place(self%loaded) = 1
    place(tangent%rows%column) = 1
    moved(tangent%directions%column) = 1
    where (tangent%bulk_of == 0) moved = 0
    associate (K => tangent%stiffness, D_R => tangent%by_imbalance, D_u => tangent%by_displacement)
      place(D_R%column) = 1
      place(D_u%column) = 1
      do i = 1, size(place)
        if (moved(i) > 0) place(i) = 1
        if (D_R%first(i + 1) > D_R%first(i) .or. D_u%first(i + 1) > D_u%first(i)) place(i) = 1
        do p = K%first(i), K%first(i + 1) - 1
          if (moved(i) > 0) place(K%column(p)) = 1
          if (moved(K%column(p)) > 0) place(i) = 1
        end do
      end do
    end associate
    unknown = pack([(i, i=1, size(place))], place > 0)
    place(unknown) = [(i, i=1, size(unknown))]
    moved(pack([(i, i=1, size(moved))], moved > 0)) = [(i, i=1, count(moved > 0))]
  end subroutine number_unknowns


  !> u = W - D A W, and the shift - D A W of the moved unknowns.
  pure subroutine project_onto_rows(tangent, place, moved, u, shift)
    type(coarse_rows_type), intent(in) :: tangent
    integer, intent(in) :: place(:), moved(:)      !< (n_unknowns)
    real(SP), intent(inout), contiguous :: u(:, :)   !< (BLOCK_DIRECTIONS, unknowns)
    real(SP), intent(out), contiguous :: shift(:, :)          !< (BLOCK_DIRECTIONS, moved unknowns)
    real(SP) :: gap(BLOCK_DIRECTIONS)
    integer :: i, p
    shift = 0.0_SP
    associate (A => tangent%rows, D => tangent%directions)
      do i = 1, A%n_rows
        gap = 0.0_SP
        do p = A%first(i), A%first(i + 1) - 1
          call add_multiple(real(A%value(p), SP), u(:, place(A%column(p))), gap)
        end do
        do p = D%first(i), D%first(i + 1) - 1
          if (moved(D%column(p)) == 0) cycle
          shift(:, moved(D%column(p))) = shift(:, moved(D%column(p))) - real(D%value(p), SP) * gap
        end do
      end do
    end associate
    do i = 1, size(moved)
      if (moved(i) > 0) u(:, place(i)) = u(:, place(i)) + shift(:, moved(i))
    end do
  end subroutine project_onto_rows


  !> f = f + K shift at the free unknowns of the bulk.
  pure subroutine add_stiffness_product(tangent, place, unknown, moved, shift, f)
    type(coarse_rows_type), intent(in) :: tangent
    integer, intent(in) :: place(:), moved(:)      !< (n_unknowns)
    integer, intent(in) :: unknown(:)              !< all others are neither moved nor coupled with moved ones
    real(SP), intent(in), contiguous :: shift(:, :)   !< (BLOCK_DIRECTIONS, moved unknowns)
    real(SP), intent(inout), contiguous :: f(:, :)   !< (BLOCK_DIRECTIONS, unknowns)
    real(SP) :: own(BLOCK_DIRECTIONS), sum(BLOCK_DIRECTIONS)
    integer :: k, i, j, p
    associate (K_bulk => tangent%stiffness)
      do k = 1, size(unknown)
        i = unknown(k)
        sum = 0.0_SP
        if (moved(i) > 0) own = shift(:, moved(i))
        do p = K_bulk%first(i), K_bulk%first(i + 1) - 1
          j = K_bulk%column(p)
          if (moved(j) > 0) call add_multiple(real(K_bulk%value(p), SP), shift(:, moved(j)), sum)
          if (moved(i) == 0 .or. i == j) cycle
          if (tangent%bulk_of(j) > 0) call add_multiple(real(K_bulk%value(p), SP), own, f(:, place(j)))
        end do
        if (tangent%bulk_of(i) > 0) f(:, k) = f(:, k) + sum
      end do
    end associate
  end subroutine add_stiffness_product


  !> f = (1 + D_R) f - D_u u.
  pure subroutine subtract_contact_forces(tangent, place, unknown, u, f)
    type(coarse_rows_type), intent(in) :: tangent
    integer, intent(in) :: place(:)                !< (n_unknowns)
    integer, intent(in) :: unknown(:)
    real(SP), intent(in), contiguous :: u(:, :)   !< (BLOCK_DIRECTIONS, unknowns)
    real(SP), intent(inout), contiguous :: f(:, :)   !< (BLOCK_DIRECTIONS, unknowns)
    real(SP) :: sum(BLOCK_DIRECTIONS)
    real(SP), allocatable :: change(:, :)
    integer, allocatable :: changed(:)
    integer :: k, p
    associate (D_R => tangent%by_imbalance, D_u => tangent%by_displacement)
      changed = pack([(k, k=1, size(unknown))], D_R%first(unknown + 1) > D_R%first(unknown) .or. &
        D_u%first(unknown + 1) > D_u%first(unknown))
      allocate (change(BLOCK_DIRECTIONS, size(changed)))
      do k = 1, size(changed)
        associate (i => unknown(changed(k)))
          sum = 0.0_SP
          do p = D_R%first(i), D_R%first(i + 1) - 1
            call add_multiple(real(D_R%value(p), SP), f(:, place(D_R%column(p))), sum)
          end do
          do p = D_u%first(i), D_u%first(i + 1) - 1
            call add_multiple(-real(D_u%value(p), SP), u(:, place(D_u%column(p))), sum)
          end do
          change(:, k) = sum
        end associate
      end do
    end associate
    do k = 1, size(changed)
      f(:, changed(k)) = f(:, changed(k)) + change(:, k)
    end do
  end subroutine subtract_contact_forces


  !> y = y + a x for the directions of a block.
  pure subroutine add_multiple(a, x, y)
    real(SP), intent(in) :: a
    real(SP), intent(in) :: x(BLOCK_DIRECTIONS)
    real(SP), intent(inout) :: y(BLOCK_DIRECTIONS)
    integer :: k
    !$omp simd
    do k = 1, BLOCK_DIRECTIONS
      y(k) = y(k) + a * x(k)
    end do
  end subroutine add_multiple


  !> The free unknowns on which the numbered unknowns depend.
  subroutine number_free(self, tangent, unknown, free_place)
    type(coarse_space_type), intent(inout) :: self
    type(coarse_rows_type), intent(in) :: tangent
    integer, intent(in) :: unknown(:)
    integer, allocatable, intent(out) :: free_place(:)        !< (n_free) number; 0: none
    integer :: k, p
    allocate (free_place(size(tangent%unknown_of)), source=0)
    associate (T => tangent%transformation)
      do k = 1, size(unknown)
        if (tangent%bulk_of(unknown(k)) == 0) cycle
        do p = T%first(unknown(k)), T%first(unknown(k) + 1) - 1
          free_place(T%column(p)) = 1
        end do
      end do
    end associate
    self%free = pack([(k, k=1, size(free_place))], free_place > 0)
    free_place(self%free) = [(k, k=1, size(self%free))]
    if (allocated(self%test)) then
      if (size(self%test, 2) /= size(self%free)) deallocate (self%test, self%image)
    end if
    if (.not. allocated(self%test)) allocate (self%test(self%n, size(self%free)), self%image(self%n, size(self%free)))
  end subroutine number_free


  !> W and J W = T'f of a block of directions on the free unknowns.
  pure subroutine restrict(self, tangent, place, unknown, free_place, first, u, f)
    type(coarse_space_type), intent(inout) :: self
    type(coarse_rows_type), intent(in) :: tangent
    integer, intent(in) :: place(:)                !< (n_unknowns)
    integer, intent(in) :: unknown(:)
    integer, intent(in) :: free_place(:)           !< (n_free)
    integer, intent(in) :: first                   !< direction
    real(SP), intent(in), contiguous :: u(:, :), f(:, :)   !< (BLOCK_DIRECTIONS, unknowns)
    integer :: k, p, i, n, last
    n = min(BLOCK_DIRECTIONS, self%n - first + 1)
    last = first + n - 1
    do k = 1, size(self%free)
      i = tangent%unknown_of(self%free(k))
      if (place(i) > 0) then
        self%test(first:last, k) = u(:n, place(i))
      else
        self%test(first:last, k) = self%w(i, first:last)
      end if
    end do
    self%image(first:last, :) = 0.0_SP
    associate (T => tangent%transformation)
      do k = 1, size(unknown)
        if (tangent%bulk_of(unknown(k)) == 0) cycle
        do p = T%first(unknown(k)), T%first(unknown(k) + 1) - 1
          i = free_place(T%column(p))
          self%image(first:last, i) = self%image(first:last, i) + real(T%value(p), SP) * f(:n, k)
        end do
      end do
    end associate
  end subroutine restrict


  !> y = inv(E) W'd, the displacement g = W y without the contact rows, and d = d - J W y.
  subroutine apply_coarse_correction(self, d, g, is_corrected)
    type(coarse_space_type), intent(in) :: self
    real(DP), intent(inout) :: d(:)                !< (n_free) [force]
    real(DP), intent(out) :: g(:)                  !< (n_unknowns) [length]
    logical, intent(out) :: is_corrected           !< .false.: there is no coarse space, d is not changed
    real(SP), allocatable :: rest(:), amount(:), part(:)
    real(SP) :: partial(self%n, N_SHARES)
    real(DP) :: y(self%n, 1), scale, length
    integer :: status, n, low, rows, share
    g = 0.0_DP
    scale = 0.0_DP
    if (self%is_ready) scale = maxval(abs(d(self%free)))
    is_corrected = scale > 0.0_DP
    if (.not. is_corrected) return
    n = size(self%free)
    rest = real(d(self%free) / scale, SP)
    partial = 0.0_SP
    !$omp parallel do private(low, rows)
    do share = 1, N_SHARES
      call bounds_of_share(n, share, low, rows)
      call sgemv('N', self%n, rows, 1.0_SP, self%test(1, low), self%n, rest(low), 1, 0.0_SP, partial(1, share), 1)
    end do
    !$omp end parallel do
    y(:, 1) = real(sum(partial, dim=2), DP)
    call dgetrs('N', self%n, 1, self%lu, self%n, self%pivots, y, self%n, status)
    length = maxval(abs(y))
    is_corrected = length > 0.0_DP .and. length <= huge(length)
    if (.not. is_corrected) return
    amount = real(y(:, 1) / length, SP)
    !$omp parallel do private(low, rows)
    do share = 1, N_SHARES
      call bounds_of_share(n, share, low, rows)
      call sgemv('T', self%n, rows, 1.0_SP, self%image(1, low), self%n, amount, 1, 0.0_SP, rest(low), 1)
    end do
    !$omp end parallel do
    d(self%free) = d(self%free) - scale * length * real(rest, DP)
    !$omp parallel do private(part, rows) schedule(static)
    do low = 1, size(g), BLOCK_ROWS
      rows = min(BLOCK_ROWS, size(g) - low + 1)
      allocate (part(rows))
      call sgemv('N', rows, self%n, 1.0_SP, self%w(low, 1), size(g), amount, 1, 0.0_SP, part, 1)
      g(low:low + rows - 1) = scale * length * real(part, DP)
      deallocate (part)
    end do
    !$omp end parallel do
  end subroutine apply_coarse_correction


  !> The part of n columns that belongs to a share.
  pure subroutine bounds_of_share(n, share, low, columns)
    integer, intent(in) :: n, share
    integer, intent(out) :: low                    !< first column, at most n
    integer, intent(out) :: columns                !< of the share; 0: none
    integer :: width
    width = (n + N_SHARES - 1) / N_SHARES
    low = min((share - 1) * width + 1, n)
    columns = max(0, min(width, n - (share - 1) * width))
  end subroutine bounds_of_share

end module amontons_contact_coarse_space
